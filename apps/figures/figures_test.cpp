// Tests of the papers' figures: their measured numbers lie within their bounds.
#include "apps/figures/figures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "apps/figures/measure.h"
#include "devices/cpu/cpu_device.h"

namespace umbrage {
namespace {

/// Expects `count` figures with pictures `size` pixels wide, and all their numbers within bounds.
void expect_figures(const Result<std::vector<Figure>>& figures, std::size_t count, int size) {
  ASSERT_TRUE(figures) << figures.error().message;
  ASSERT_EQ(figures->size(), count);
  for (const Figure& figure : *figures) {
    EXPECT_FALSE(figure.numbers.empty()) << figure.id;
    for (const FigureNumber& number : figure.numbers)
      EXPECT_TRUE(number.holds()) << "figure " << figure.id << ": " << number.what << " is " << number.value
                                  << ", not within " << number.min << " and " << number.max;
    for (const FigurePicture& picture : figure.pictures) {
      EXPECT_EQ(picture.image.width, size);
      EXPECT_EQ(picture.command.rfind("umbrage ", 0), 0u);
    }
  }
}

TEST(Figures, EveryNumberOfTheUnsharpPaperHolds) {
  ASSERT_TRUE(std::filesystem::exists(kBunnyFile)) << "install glmark2-data (scripts/setup does)";
  const auto device = make_cpu_device();
  expect_figures(unsharp_figures(*device, {.size = 1024}), 5, 1024);
}

TEST(Figures, EveryNumberOfTheCartoonPaperHolds) {
  const auto device = make_cpu_device();
  expect_figures(cartoon_figures(*device, {.size = 512}), 9, 512);
}

TEST(Figures, EveryNumberOfTheBleedingPaperHolds) {
  const auto device = make_cpu_device();
  expect_figures(bleeding_figures(*device, {.size = 256}), 10, 256);
}

TEST(Figures, ANumberOutsideItsBoundDoesNotHold) {
  EXPECT_TRUE((FigureNumber{"", 0.5, 0.5, 1.0}).holds());
  EXPECT_FALSE((FigureNumber{"", 0.4, 0.5, 1.0}).holds());
  EXPECT_FALSE((FigureNumber{"", std::nan(""), 0.0, 1.0}).holds());
}

TEST(Figures, WidthOfFallIsBetweenTheTwoLevels) {
  EXPECT_NEAR(width_of_fall({0.2, 1.0, 0.5, 0.0}), 1.6, 1e-12);  // 90 % at 1.2, 10 % at 2.8
  EXPECT_TRUE(std::isnan(width_of_fall({1.0, 0.5})));
  EXPECT_TRUE(std::isnan(width_of_fall({})));
}

TEST(Figures, HueDoesNotDependOnBrightnessAndGrey) {
  EXPECT_NEAR(hue_difference_deg({0.9, 0.1, 0.1}, {0.5, 0.3, 0.3}), 0.0, 1e-5);
  EXPECT_NEAR(hue_difference_deg({1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}), 120.0, 1e-9);
}

TEST(Figures, SparksAreFarAboveTheMedianNearThem) {
  Plane plane(9, 9, 0.1f);
  plane.at(4, 4) = 0.79f;
  EXPECT_EQ(count_sparks(plane, 0.02f), 0);
  plane.at(4, 4) = 0.81f;
  EXPECT_EQ(count_sparks(plane, 0.02f), 1);
  EXPECT_EQ(count_sparks(plane, 0.11f), 0);
  plane.at(1, 4) = 0.81f;  // too close to the border
  EXPECT_EQ(count_sparks(plane, 0.02f), 1);
}

TEST(Figures, ContactSheetShowsEveryPicture) {
  Image white(64, 64), black(64, 64);
  for (const char* name : {"color.r", "color.g", "color.b"}) {
    white.add(name) = Plane(64, 64, 0.75f);
    black.add(name) = Plane(64, 64, 0.25f);
  }
  const Image sheet = contact_sheet({{"1", "one", {{"a.png", "a", "", white}, {"b.png", "b", "", black}}, {}}}, 32);
  long bright = 0, dark = 0;
  for (int y = 0; y < sheet.height; ++y)
    for (int x = 0; x < sheet.width; ++x) {
      bright += sheet.plane("color.g").at(x, y) == 0.75f;
      dark += sheet.plane("color.g").at(x, y) == 0.25f;
    }
  EXPECT_EQ(bright, 32 * 32);
  EXPECT_EQ(dark, 32 * 32);
}

TEST(Figures, ContactSheetShowsADetailUnscaled) {
  Image picture(64, 64);
  for (const char* name : {"color.r", "color.g", "color.b"}) {
    Plane& plane = picture.add(name) = Plane(64, 64, 0.75f);
    for (int y = 24; y < 40; ++y)
      for (int x = 24; x < 40; ++x) plane.at(x, y) = 0.25f;
  }
  const auto dark = [&](bool detail) {
    const Image sheet = contact_sheet({{"1", "one", {{"a.png", "a", "", picture, detail}}, {}}}, 32);
    long count = 0;
    for (int y = 0; y < sheet.height; ++y)
      for (int x = 0; x < sheet.width; ++x) count += sheet.plane("color.g").at(x, y) == 0.25f;
    return count;
  };
  EXPECT_EQ(dark(false), 8 * 8);
  EXPECT_EQ(dark(true), 16 * 16);
}

}  // namespace
}  // namespace umbrage
