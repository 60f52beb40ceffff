// Tests which occluders `bitmask` searches: those within the radius, and which mip level a distant tap reads.
#include <gtest/gtest.h>

#include <cmath>

#include "effects/bitmask/bitmask_test_scenes.h"

namespace umbrage {
namespace {

using test::joined;
using test::kPi;
using test::Settings;

constexpr double kPixel = 5.0 / test::kSide;  // width of a pixel of floor_from_above, scene units

const Settings kSettings = joined(test::kFineSettings, {{"slices", "32"}, {"steps", "256"}});

// ---- radius

/// Returns the integral of the squared sine of the elevation of a step's edge, over the azimuths from the direction
/// towards the step to `azimuth`. The step is infinitely long, at the distance `a`, of height `h`.
double occluded_to(double azimuth, double a, double h) {
  const double edge = std::hypot(a, h);
  return azimuth - a / edge * std::atan(a * std::tan(azimuth) / edge);
}

/// Returns the occlusion of a floor in front of two infinitely long steps of height `h`, at right angles, at the
/// distances `a` and `b`. Only edges within `radius` occlude.
double occlusion_before_steps(double a, double b, double h, double radius) {
  const double reach = std::sqrt(radius * radius - h * h);  // along the floor
  const double corner = std::atan2(b, a);                   // azimuth of the corner, from the direction towards `a`
  const auto of_step = [&](double distance, double to_corner) {
    if (!(distance < reach)) return 0.0;
    const double last = std::acos(distance / reach);
    return occluded_to(last, distance, h) + occluded_to(std::min(last, to_corner), distance, h);
  };
  return (of_step(a, corner) + of_step(b, 0.5 * kPi - corner)) / (2.0 * kPi);
}

TEST(BitmaskRadius, StepsBeyondTheRadiusDoNotOcclude) {
  constexpr double kFar = 64.0, kHeight = 0.3;  // kFar: outside the picture
  struct Steps {
    double a, b;
    const char* mode;
  };
  for (const Steps& steps : {Steps{64.5 * kPixel, kFar, "infinite"}, Steps{64.5 * kPixel, 80.5 * kPixel, "thick"}}) {
    GBuffer g = test::floor_from_above([&](double x, double y) { return x > steps.a || y > steps.b ? kHeight : 0.0; });
    g.info.scene_radius = 4.0f;
    for (const double radius : {0.52, 0.6, 0.8, 2.0}) {
      const double expected = 1.0 - occlusion_before_steps(steps.a, steps.b, kHeight, radius);
      const std::string text = radius == 0.6 ? "15%" : fmt::format("{}", radius);
      const auto ao =
          test::mean_values_at_middle(g, joined(kSettings, {{"radius", text}, {"mode", steps.mode}}), {"ao"});
      EXPECT_NEAR(ao[0], expected, 8e-3) << text << ' ' << steps.mode;
    }
  }
}

TEST(BitmaskRadius, TheSearchEndsAtTheRadius) {
  // The floor of a round well. Its edge is at one distance in all directions, just within the radius or just beyond.
  constexpr double kHeight = 0.4, kRadius = 1.2;
  const double reach = std::sqrt(kRadius * kRadius - kHeight * kHeight);  // 1.131 along the floor
  for (const double width : {1.1, 1.16}) {
    const GBuffer g =
        test::floor_from_above([&](double x, double y) { return std::hypot(x, y) > width ? kHeight : 0.0; });
    const double expected = width < reach ? width * width / (width * width + kHeight * kHeight) : 1.0;
    for (const char* mode : {"thick", "infinite"}) {
      const auto ao = test::mean_values_at_middle(g, joined(kSettings, {{"radius", "1.2"}, {"mode", mode}}), {"ao"});
      EXPECT_NEAR(ao[0], expected, 6e-3) << width << ' ' << mode;
    }
  }
}

// ---- mip levels

TEST(BitmaskMips, TapsReadTheLevelOfATenthOfTheirDistance) {
  // A floor in the picture and in all levels but one, which shows a surface above the floor. It occludes from the
  // distance on at which taps read this level: where a pixel of the next level would be wider than a tenth of it.
  for (int level = 1; level <= 5; ++level) {
    const double nearest_px = std::exp2(level + 3.3), ratio = 0.6;  // height of the surface over that distance
    const double height = ratio * nearest_px * kPixel;
    GBuffer g = test::floor_from_above([](double, double) { return 0.0; });
    const Settings settings =
        joined(kSettings,
               {{"mips", "on"}, {"mode", "infinite"}, {"radius", "2.4"}, {"distribution", "1"}, {"border", "open"}});
    const auto constants = test::constants_of<BitmaskConstants>("bitmask", g.info, settings);
    ASSERT_EQ(constants.mip_levels, 5);
    const auto first_row = [&](int of) { return int(2.0 * constants.mip_rows * (1.0 - std::exp2(1 - of))); };
    Plane& mips = g.layers[0].add("bitmask_mips") = Plane(test::kSide, test::kSide, 5.0f);
    for (int y = first_row(level); y < first_row(level + 1); ++y)
      for (int x = 0; x < test::kSide; ++x) mips.at(x, y) = float(5.0 - height);
    const auto ao = test::mean_values_at_middle(g, settings, {"ao"});
    EXPECT_NEAR(ao[0], 1.0 - ratio * ratio / (1.0 + ratio * ratio), 0.03) << "level " << level;
  }
}

TEST(BitmaskMips, LevelsOfAPlaneAreItsDepthsAndLeaveItUnoccluded) {
  const int width = 157, height = 123;
  for (const bool orthographic : {false, true})
    for (const double tilt_deg : {35.0, 70.0}) {
      const double tilt = tilt_deg * test::kRadian, azimuth = 0.6;
      const glm::dvec3 normal(std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), std::cos(tilt));
      const Camera camera = test::camera_of(orthographic, 4.0, width, height);
      const GBuffer g = test::picture(width, height, camera, {{{0.0, 0.0, -5.0}, normal}});
      const Settings settings = {{"mips", "on"}, {"radius", "4"}, {"slices", "1"}, {"steps", "12"}};
      const auto constants = test::constants_of<BitmaskConstants>("bitmask", g.info, settings);
      ASSERT_GE(constants.mip_levels, 3);
      const auto depth_at = [&](double x, double y) {  // of the plane, at any point of the picture
        const double u = camera.left + (camera.right - camera.left) * x / width;
        const double v = camera.top - (camera.top - camera.bottom) * y / height;
        const double lean = normal.x * u + normal.y * v;
        return orthographic ? 5.0 + lean / normal.z : 5.0 * normal.z / (normal.z - lean);
      };
      test::on_every_target("bitmask", g, settings, [&](const Image& image) {
        const Plane &ao = image.plane("ao"), &mips = image.plane("bitmask_mips");
        long occluded = 0, other = 0, compared = 0;
        for (int y = 0; y < height; ++y)
          for (int x = 0; x < width; ++x) occluded += std::fabs(ao.at(x, y) - 1.0f) > 1e-6f;
        EXPECT_EQ(occluded, 0) << tilt_deg << ' ' << orthographic;
        for (int level = 1, top = 0; level <= constants.mip_levels; top += constants.mip_rows >> (level - 1), ++level) {
          const int size = 1 << level;
          for (int y = 0; y < height >> level; ++y)
            for (int x = 0; x < width >> level; ++x) {
              // The plane is deepest in the upper right corner.
              const double nearest = depth_at(size * x, size * (y + 1)), deepest = depth_at(size * (x + 1), size * y);
              if (!(nearest > 0.0 && deepest > 0.0 && deepest - nearest < 0.3))
                continue;  // or the nearest are left out
              // In perspective the mean of the depths is slightly above the depth of the centre.
              const double off = mips.at(x, top + y) - depth_at(size * (x + 0.5), size * (y + 0.5));
              other += !(off > -1e-4 && off < (orthographic ? 1e-4 : 1e-4 + 0.1 * (deepest - nearest)));
              ++compared;
            }
        }
        EXPECT_GT(compared, 1000) << tilt_deg << ' ' << orthographic;
        EXPECT_EQ(other, 0) << tilt_deg << ' ' << orthographic;
      });
    }
}

}  // namespace
}  // namespace umbrage
