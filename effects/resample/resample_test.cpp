// Tests `resample`: which pixels it marks, and that borrowed values come from the pixel's own surface.
#include "effects/resample/resample.h"

#include <gtest/gtest.h>

#include <cmath>

#include "run_effect.h"
#include "support.h"

namespace umbrage {
namespace {

using namespace test;

constexpr int kWidth = 67, kHeight = 29;

/// Returns two planes that face the camera: pixels left of column `first` are at depth `left`, the others at `right`.
GBuffer two_planes(int first, float left, float right) {
  GBuffer g = empty_gbuffer(kWidth, kHeight);
  Image& image = g.layers[0];
  image.add("depth") = Plane(kWidth, kHeight, left);
  for (int y = 0; y < kHeight; ++y)
    for (int x = first; x < kWidth; ++x) image.plane("depth").at(x, y) = right;
  for (const char* name : kNormal) image.add(name) = Plane(kWidth, kHeight, name == kNormal[2] ? 1.0f : 0.0f);
  return g;
}

/// Adds a plane with one value left of column `first` and another from there on.
void add_step(GBuffer& g, const std::string& name, int first, float left, float right) {
  Plane& plane = g.layers[0].add(name) = Plane(kWidth, kHeight, left);
  for (int y = 0; y < kHeight; ++y)
    for (int x = first; x < kWidth; ++x) plane.at(x, y) = right;
}

/// Expects that exactly the columns [begin, end) are marked.
void expect_marked(const GBuffer& g, const Settings& settings, int begin, int end) {
  on_every_target("resample", g, settings, [&](const Image& made) {
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        ASSERT_EQ(made.plane("marks").at(x, y), x >= begin && x < end ? 1.0f : 0.0f) << x << ", " << y;
  });
}

TEST(Resample, MarksBothSidesOfADepthDiscontinuityAndThePixelsBeside) {
  expect_marked(two_planes(30, 5.0f, 8.0f), {}, 28, 32);
  expect_marked(two_planes(30, 5.0f, INFINITY), {}, 28, 32);
  expect_marked(two_planes(30, 5.0f, 5.0f), {}, 0, 0);
  expect_marked(two_planes(30, INFINITY, INFINITY), {}, 0, 0);
}

TEST(Resample, MarksStepsOfAlbedoAndHardShadows) {
  GBuffer g = two_planes(0, 5.0f, 5.0f);
  for (const char* name : kAlbedo) add_step(g, name, 40, 0.25f, 0.49f);  // 0.5 and 0.7 as square roots
  expect_marked(g, {}, 39, 41);
  expect_marked(g, {{"albedo", "0.3"}}, 0, 0);

  GBuffer shaded = two_planes(0, 5.0f, 5.0f);
  add_step(shaded, "shadow2", 20, 1.0f, 0.0f);
  expect_marked(shaded, {{"hard_shadows", "4"}}, 19, 21);
  expect_marked(shaded, {{"hard_shadows", "3"}}, 0, 0);
}

TEST(Resample, MarksCreases) {
  GBuffer g = two_planes(0, INFINITY, 5.0f);
  const float angle = 0.4f;  // radians; 22.9 degrees
  for (int y = 0; y < kHeight; ++y)
    for (int x = 33; x < kWidth; ++x) {
      g.layers[0].plane("normal.y").at(x, y) = std::sin(angle);
      g.layers[0].plane("normal.z").at(x, y) = std::cos(angle);
    }
  expect_marked(g, {{"distance", "100"}}, 32, 34);
  expect_marked(g, {{"distance", "100"}, {"crease", "25"}}, 0, 0);
}

/// Adds the planes of a first sample whose left surface ends at another column.
void add_first(GBuffer& g, int first, float left, float right) {
  const GBuffer other = two_planes(first, left, right);
  g.layers[0].add("other_resample_depth") = other.layers[0].plane("depth");
  for (const char* name : kNormal) g.layers[0].add(std::string("other_") + name) = other.layers[0].plane(name);
}

TEST(Resample, BorrowsFromTheOwnSurface) {
  GBuffer g = two_planes(31, 5.0f, 8.0f);  // the edge is a pixel farther to the right than in the first sample
  add_first(g, 30, 5.0f, 8.0f);
  add_step(g, "other_ao", 30, 0.25f, 0.75f);
  for (const char* name : kIndirect) add_step(g, std::string("other_") + name, 30, 3.0f, 0.5f);
  add_step(g, "other_shadow", 30, 0.125f, 1.0f);
  add_step(g, "other_shadow4", 30, 0.5f, 0.0f);
  add_step(g, "shadow1", 0, 0.0f, 0.625f);  // captured, not borrowed
  const Settings settings = {
      {"part", "borrow"}, {"occlusion", "light"}, {"soft_shadows", "17"}, {"right", "0.4"}, {"below", "-0.2"}};
  on_every_target("resample", g, settings, [&](const Image& made) {
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const bool left = x < 31;
        ASSERT_NEAR(made.plane("ao").at(x, y), left ? 0.25f : 0.75f, 1e-4f) << x << ", " << y;
        ASSERT_NEAR(made.plane("indirect.g").at(x, y), left ? 3.0f : 0.5f, 1e-4f);
        ASSERT_NEAR(made.plane("shadow").at(x, y), left ? 0.125f : 1.0f, 1e-4f);
        ASSERT_NEAR(made.plane("shadow4").at(x, y), left ? 0.5f : 0.0f, 1e-4f);
        ASSERT_EQ(made.find("shadow1"), nullptr);  // not written
      }
  });
}

TEST(Resample, AConstantStaysBitwiseTheSame) {
  GBuffer g = bumpy_gbuffer(kWidth, kHeight, 3);
  g.layers[0].add("other_resample_depth") = g.layers[0].plane("depth");
  for (const char* name : kNormal) g.layers[0].add(std::string("other_") + name) = g.layers[0].plane(name);
  g.layers[0].add("other_ao") = Plane(kWidth, kHeight, 0.37f);
  on_every_target("resample", g, {{"part", "borrow"}, {"right", "0.3"}}, [&](const Image& made) {
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) ASSERT_EQ(made.plane("ao").at(x, y), 0.37f) << x << ", " << y;
  });
}

}  // namespace
}  // namespace umbrage
