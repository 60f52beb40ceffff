// Depths in steps: what they are taken for, and the surfaces that smoothing finds.
#include "gbuffers/steps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace umbrage {
namespace {

constexpr float kNone = std::numeric_limits<float>::infinity();
constexpr int kWidth = 160, kHeight = 320;
constexpr float kPixel = 1.0f / kHeight;  // width of a pixel at depth 1

/// View depth of a floor below the camera, with a box that stands on it, and the sky above.
double depth_at(int x, int y) {
  if (y < 40) return kNone;
  if (x > 90 && x < 140 && y < 200) return 3.0 - 0.004 * (x - 90);  // a wall, which turns away
  return 1.0 / (0.1 + 0.0025 * (y - 40));
}

/// The same, rounded to a step in inverse depth as a depth camera does, or in depth.
Plane stored(double step, bool inverse) {
  Plane depth(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const double d = depth_at(x, y);
      depth.at(x, y) = float(inverse ? 1.0 / (std::round(1.0 / d / step) * step) : std::round(d / step) * step);
      if (std::isinf(d)) depth.at(x, y) = kNone;
    }
  return depth;
}

std::vector<float> steps_of(const Plane& depth, float unit = 0.0f) {
  return depth_steps(std::vector<Plane>{depth}, kPixel, false, unit);
}

/// RMS difference of the floor's change of inverse depth from row to row, relative to the true change, in rows from
/// `first` on.
double floor_error(const Plane& depth, int first = 80) {
  double sum = 0.0;
  int count = 0;
  for (int y = first; y < kHeight - 1; ++y)
    for (int x = 0; x < 60; ++x) {
      const double slope = 1.0 / depth.at(x, y + 1) - 1.0 / depth.at(x, y);
      sum += (slope / 0.0025 - 1.0) * (slope / 0.0025 - 1.0);
      ++count;
    }
  return std::sqrt(sum / count);
}

TEST(DepthSteps, AreRecognised) {
  EXPECT_FALSE(steps_of(stored(0.005, true)).empty());
  EXPECT_FALSE(steps_of(stored(0.02, false)).empty());
  EXPECT_TRUE(steps_of(stored(1e-7, false)).empty()) << "floats";
  Plane small(48, 64);  // exact depths of few values: a floor with a ball
  for (int y = 0; y < small.height; ++y)
    for (int x = 0; x < small.width; ++x) {
      const float dx = (float(x) - 24.0f) / 9.0f, dy = (float(y) - 30.0f) / 9.0f, square = 1.0f - dx * dx - dy * dy;
      small.at(x, y) = square > 0.0f ? 4.0f - std::sqrt(square) : 100.0f / (10.0f + float(y));
    }
  EXPECT_TRUE(steps_of(small).empty()) << "few pixels";
  Plane plateaus(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) plateaus.at(x, y) = 1.0f + float((x / 16 * 7 + y / 16 * 3) % 40);
  EXPECT_TRUE(steps_of(plateaus).empty()) << "a model of blocks";
}

TEST(DepthSteps, BecomeTheSurface) {
  for (const bool inverse : {true, false}) {
    const Plane depth = stored(inverse ? 0.005 : 0.02, inverse);
    const auto levels = steps_of(depth);
    const Plane smooth = smoothed_steps(depth, {0, kHeight}, levels, false, 0.0f);
    EXPECT_GT(floor_error(depth), 0.9) << inverse;
    EXPECT_LT(floor_error(smooth), 0.25) << inverse;
    EXPECT_LT(floor_error(smooth, kHeight - 5), 0.25) << "at the border " << inverse;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const auto at = std::lower_bound(levels.begin(), levels.end(), depth.at(x, y));
        if (std::isinf(depth.at(x, y))) {
          EXPECT_EQ(smooth.at(x, y), kNone);
          continue;
        }
        const float below = at == levels.begin() ? *at : at[-1], above = at + 1 == levels.end() ? *at : at[1];
        EXPECT_GE(smooth.at(x, y), below * 0.999999f) << x << ' ' << y;
        EXPECT_LE(smooth.at(x, y), above * 1.000001f) << x << ' ' << y;
      }
  }
}

TEST(DepthSteps, OfAKnownUnitAreSmoothedWithinIt) {
  // Too few pixels of each step to see them.
  Plane depth(40, 400);
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x)
      depth.at(x, y) = std::round(1000.0f / (1.0f + 0.01f * float(y)) + float(x) / 7.0f);
  EXPECT_TRUE(steps_of(depth).empty());
  EXPECT_FALSE(steps_of(depth, 1.0f).empty());
  EXPECT_TRUE(steps_of(depth, 0.1f).empty()) << "steps that tilt nothing";
  std::vector<float> levels;
  for (int y = 0; y < depth.height; ++y) levels.push_back(depth.at(0, depth.height - 1 - y));
  std::sort(levels.begin(), levels.end());
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  add_levels(depth, levels);
  const Plane smooth = smoothed_steps(depth, {0, depth.height}, levels, false, 1.0f);
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x)
      ASSERT_LE(std::abs(smooth.at(x, y) - depth.at(x, y)), 1.001f) << x << ' ' << y;
}

TEST(DepthSteps, OfTheWholePictureAreCollected) {
  std::vector<float> levels = {2.0f, 5.0f};
  Plane rows(3, 2, 5.0f);
  rows.at(0, 0) = 7.0f;
  rows.at(1, 0) = 1.0f;
  rows.at(0, 1) = kNone;
  rows.at(2, 1) = 7.0f;
  add_levels(rows, levels);
  EXPECT_EQ(levels, (std::vector<float>{1.0f, 2.0f, 5.0f, 7.0f}));
}

TEST(DepthSteps, RowsDoNotDependOnTheRowsBeside) {
  const Plane depth = stored(0.02, false);
  const auto levels = steps_of(depth);
  const Plane whole = smoothed_steps(depth, {0, kHeight}, levels, false, 0.0f);
  const int begin = 130, end = 170, first = begin - kStepsMargin, last = end + kStepsMargin;
  Plane part(kWidth, last - first);
  for (int y = first; y < last; ++y) std::copy_n(depth.row(y), kWidth, part.row(y - first));
  const Plane rows = smoothed_steps(part, {begin - first, end - first}, levels, false, 0.0f);
  for (int y = begin; y < end; ++y)
    for (int x = 0; x < kWidth; ++x) ASSERT_EQ(rows.at(x, y - begin), whole.at(x, y)) << x << ' ' << y;
}

}  // namespace
}  // namespace umbrage
