// Metering of pictures of 100 metered pixels, against stops calculated by hand.
#include "looks/metering.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace umbrage {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kSide = 30;  // one pixel in 3 is metered, across and down: 100 in all

/// Some of the metered pixels and their luminance.
struct Part {
  int count;
  float luminance;
};

/// Returns the planes of a grey picture, row by row in the order of the parts. Pixels that are not metered are black.
Image picture_of(const std::vector<Part>& parts) {
  Image image(kSide, kSide);
  for (const std::string& name : kMeteredPlanes) image.add(name) = Plane(kSide, kSide, name == "depth" ? 1.0f : 0.0f);
  int pixel = 0;
  for (const Part& part : parts)
    for (int k = 0; k < part.count; ++k, ++pixel)
      for (int c = 0; c < 3; ++c)
        image.planes[std::size_t(c)].at(pixel % 10 * 3 + 1, pixel / 10 * 3 + 1) = part.luminance;
  EXPECT_EQ(pixel, 100);
  return image;
}

float stops_of(const Image& image, float usual = 0.0f) {
  Metering metering;
  metering.add(image, 0, image.height);
  return metering.stops(usual);
}

float stops_of(const std::vector<Part>& parts, float usual = 0.0f) { return stops_of(picture_of(parts), usual); }

/// Returns the correction half way from where this highlight is white to the median's target.
double half_way(double highlight, double to_median) {
  const double to_white = std::log2(double(kMeteredWhite) / highlight);
  return to_white + 0.5 * (to_median - to_white);
}

/// Returns what is applied of a correction.
double applied(double stops) { return stops / (1.0 + std::fabs(stops) / 16.0); }

TEST(MeteringNumbers, TheMedianUnlessHighlightsGetTooBright) {
  const float median = kMeteredMedian;
  ASSERT_FLOAT_EQ(median, 0.395f);
  ASSERT_FLOAT_EQ(kMeteredWhite, 1.05f);
  // One stop below, whatever the 3 % that are highlights.
  EXPECT_NEAR(stops_of({{100, median / 2}}), applied(1.0), 1e-5);
  EXPECT_NEAR(stops_of({{97, median / 2}, {3, 16.0f}}), applied(1.0), 1e-5);
  // With 4 % they count.
  EXPECT_NEAR(stops_of({{96, median / 2}, {4, 4.0f}}), applied(half_way(4.0, 1.0)), 1e-5);
  // A dark hall, in which the sun shines on a tenth.
  EXPECT_NEAR(stops_of({{90, 0.01f}, {10, 1.0f}}), applied(half_way(1.0, std::log2(39.5))), 1e-5);
  // The 50th of 100 is the median.
  EXPECT_NEAR(stops_of({{50, median / 2}, {50, median}}), applied(1.0), 1e-5);
  EXPECT_NEAR(stops_of({{49, median / 2}, {51, median}}), 0.0, 1e-5);
  // The correction is that of the usual stops.
  EXPECT_NEAR(stops_of({{100, median / 2}}, -1.0f), -1.0 + applied(2.0), 1e-5);
  EXPECT_NEAR(stops_of({{100, median / 16}}, 0.5f), 0.5 + applied(3.5), 1e-5);
  EXPECT_NEAR(stops_of({{100, median * 16}}, 0.5f), 0.5 - applied(4.5), 1e-5);
  EXPECT_EQ(stops_of({{100, 0.0f}}, 0.5f), 0.5f) << "no light at all";
}

TEST(MeteringNumbers, BrightnessOfSurfacesInOnePixelOfThree) {
  // The brightness of a pure colour is the mean of its channel and of its luminance by Rec.709.
  const float weights[] = {0.2126f, 0.7152f, 0.0722f};
  for (std::size_t c = 0; c < 3; ++c) {
    Image image = picture_of({{100, 0.0f}});
    for (int y = 1; y < kSide; y += 3)
      for (int x = 1; x < kSide; x += 3) image.planes[c].at(x, y) = kMeteredMedian / (1.0f + weights[c]);
    EXPECT_NEAR(stops_of(image), applied(1.0), 1e-4) << c;
    // The background and what is not finite do not count.
    for (int y = 1; y < kSide; y += 3)
      for (int x = 1; x < kSide / 2; x += 3) {
        image.planes[c].at(x, y) = x == 1 ? std::nanf("") : 100.0f;
        if (x > 1) image.planes[3].at(x, y) = kInfinity;
      }
    EXPECT_NEAR(stops_of(image), applied(1.0), 1e-4) << c;
    // Rows may come in pieces.
    for (const int rows : {1, 4, 7}) {
      Metering metering;
      for (int first = 0; first < kSide; first += rows) {
        const int count = std::min(rows, kSide - first);
        Image part(kSide, count);
        for (std::size_t p = 0; p < 4; ++p) {
          Plane& plane = part.add(kMeteredPlanes[p]);
          for (int y = 0; y < count; ++y) std::copy_n(image.planes[p].row(first + y), kSide, plane.row(y));
        }
        metering.add(part, first, kSide);
      }
      EXPECT_NEAR(metering.stops(0.0f), applied(1.0), 1e-4) << rows;
      EXPECT_EQ(metering.stops(0.25f), 0.25f) << "the rows are cleared";
    }
    // 4 % that are two stops beyond white in this channel alone are highlights.
    image = picture_of({{96, kMeteredMedian / 2}, {4, 0.0f}});
    for (int x = 1; x <= 28; x += 9) image.planes[c].at(x, 28) = 4.0f;
    EXPECT_NEAR(stops_of(image), applied(half_way(4.0, 1.0)), 1e-4) << c;
  }
}

}  // namespace
}  // namespace umbrage
