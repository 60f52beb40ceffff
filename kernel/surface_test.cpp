// Tests kernel/surface.kernel.h: whether two pixels show the same surface.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "kernel/scalar_surface.h"
#include "support.h"

namespace umbrage {
namespace {

using scalar::Vec3;

constexpr int kSize = 512;
constexpr double kDepth = 5.0;

/// The points of a picture that shows one plane. Pixel (0, 0) is its centre.
struct PlanePicture {
  scalar::SurfaceText surface{};
  double pixel, scale, n[3];
  bool orthographic;

  /// Tilts the plane by angle_deg from facing the camera. `height` pixels cover a length of half the depth.
  PlanePicture(double angle_deg, bool orthographic_, double scale_ = 1.0, int height = kSize)
      : pixel(0.5 / height), scale(scale_), orthographic(orthographic_) {
    const double angle = angle_deg * std::numbers::pi / 180.0;
    n[0] = 0.6 * std::sin(angle), n[1] = 0.8 * std::sin(angle), n[2] = std::cos(angle);
    surface.F.orthographic = orthographic ? 1 : 0;
    const double unit = pixel * (orthographic ? kDepth * scale : 1.0);
    surface.F.ray_scale_x = float(unit);
    surface.F.ray_scale_y = float(-unit);
    surface.F.ray_offset_x = float(-0.5 * unit);  // pixel (0, 0) is the centre
    surface.F.ray_offset_y = float(0.5 * unit);
  }

  Vec3 normal(double error_deg = 0.0) const {
    const double steep = std::hypot(n[0], n[1]);
    const double angle = std::atan2(steep, n[2]) + error_deg * std::numbers::pi / 180.0;
    if (steep == 0.0) return {float(std::sin(angle)), 0.0f, float(std::cos(angle))};
    return {float(n[0] / steep * std::sin(angle)), float(n[1] / steep * std::sin(angle)), float(std::cos(angle))};
  }

  /// Returns the point at pixel (x, y), moved `before_px` central pixel sizes in front of the plane.
  Vec3 point(int x, int y, double before_px = 0.0) {
    const double u = x * pixel, v = -y * pixel;
    const double lean = n[0] * u + n[1] * v, before = before_px * pixel;
    const double fraction = orthographic ? 1.0 + (lean - before) / n[2] : (n[2] - before) / (n[2] - lean);
    return surface.view_position(x, y, float(kDepth * scale * fraction));
  }
};

TEST(Surface, PlanesAreOneAtAnyAngleScaleAndResolution) {
  for (const bool orthographic : {false, true})
    for (const double angle_deg : {0.0, 30.0, 60.0, 80.0, 85.0, 87.0, 89.0})
      for (const double scale : {1e-6, 1.0, 1e6})
        for (const int height : {64, 512, 8192}) {
          PlanePicture picture(angle_deg, orthographic, scale, height);
          const Vec3 here = picture.point(0, 0), normal = picture.normal();
          for (const auto& [x, y] : {std::pair(1, 0), {0, 1}, {-1, -1}, {3, 2}}) {
            const Vec3 there = picture.point(x, y);
            if (!(there.z < 0.0f) || !std::isfinite(there.z)) continue;  // beyond the horizon
            EXPECT_LE(picture.surface.surface_distance(here, normal, there, normal, 1.0f), 0.15f)
                << angle_deg << " degrees, " << height << " pixels";
          }
        }
}

TEST(Surface, WrongNormalsAreExplained) {
  for (const bool orthographic : {false, true})
    for (const double angle_deg : {0.0, 45.0, 80.0, 85.0, 87.0, 89.0})
      for (const double error_deg : {-2.0, -0.5, 0.5, 2.0}) {
        PlanePicture picture(angle_deg, orthographic);
        const Vec3 here = picture.point(0, 0), reported = picture.normal(error_deg);
        for (const int k : {1, 2, 4})
          EXPECT_LE(picture.surface.surface_distance(here, reported, picture.point(0, k), reported, 1.0f), 1.0f)
              << angle_deg << " degrees, wrong by " << error_deg;
      }
}

TEST(Surface, StepsAreTwoByTheirSizeInPixels) {
  for (const bool orthographic : {false, true})
    for (const double scale : {1e-6, 1.0, 1e6})
      for (const int height : {64, 512, 8192}) {
        PlanePicture facing(0.0, orthographic, scale, height);
        const Vec3 here = facing.point(0, 0), normal = facing.normal();
        for (const double step_px : {0.5, 3.0, -3.0}) {
          const Vec3 there = facing.point(1, 0, step_px);
          // In perspective the unit is the smaller of the two pixel sizes, that of the nearer point.
          const double nearer = orthographic ? 1.0 : std::min(1.0, -there.z / (kDepth * scale));
          const double expected = step_px / nearer;
          EXPECT_NEAR(facing.surface.plane_distance(here, normal, there, 1.0f), expected, 0.01);
          EXPECT_NEAR(facing.surface.plane_distance(here, normal, there, 2.0f), 0.5 * expected, 0.01);
          EXPECT_NEAR(facing.surface.surface_distance(here, normal, there, normal, 1.0f), std::abs(expected), 0.01);
        }
        // The tolerance for normals grows with the tilt, but must not hide a depth step.
        for (const double angle_deg : {85.0, 87.0, 89.0}) {
          PlanePicture tilted(angle_deg, orthographic, scale, height);
          if (height < 512) continue;  // with fewer rows the horizon is a few pixels away
          for (const double step_px : {-30.0, 30.0, 200.0}) {
            if (step_px * tilted.pixel > 0.8 * tilted.n[2]) continue;  // it would be behind the camera
            const Vec3 there = tilted.point(0, 1, step_px);
            if (!(there.z < 0.0f)) continue;
            EXPECT_GT(
                tilted.surface.surface_distance(tilted.point(0, 0), tilted.normal(), there, tilted.normal(), 1.0f),
                2.0f)
                << angle_deg << " degrees, " << step_px << " px of " << height;
          }
        }
      }
}

TEST(Surface, EitherPixelFindsTheOtherEquallyFar) {
  PlanePicture picture(70.0, false);
  for (const double step_px : {0.0, 1.5, 40.0}) {
    const Vec3 a = picture.point(0, 0), b = picture.point(2, 1, step_px), n = picture.normal(1.0),
               m = picture.normal(-1.5);
    EXPECT_EQ(picture.surface.surface_distance(a, n, b, m, 1.0f), picture.surface.surface_distance(b, m, a, n, 1.0f));
  }
}

TEST(Surface, TheLargerOfTheTwoDistancesCounts) {
  // A point on a plane that faces the camera, whose own plane leans: only one of the points is off the other's plane.
  for (const bool orthographic : {false, true}) {
    PlanePicture facing(0.0, orthographic);
    const Vec3 here = facing.point(0, 0), there = facing.point(8, 0), normal = facing.normal();
    for (const double lean_deg : {30.0, 60.0}) {
      const double lean = lean_deg * std::numbers::pi / 180.0;
      const Vec3 leaning = {float(std::sin(lean)), 0.0f, float(std::cos(lean))};
      EXPECT_NEAR(facing.surface.surface_distance(here, normal, there, leaning, 1.0f), 8.0 * std::sin(lean), 0.01);
      EXPECT_NEAR(facing.surface.surface_distance(there, leaning, here, normal, 1.0f), 8.0 * std::sin(lean), 0.01);
    }
  }
}

TEST(Surface, BackgroundAndNonFinitePointsAreOnNoSurface) {
  PlanePicture picture(0.0, false);
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  const Vec3 here = picture.point(0, 0), normal = picture.normal();
  const float none = scalar::SurfaceText::kOtherSurface;
  for (const float depth : {kNan, kInfinity, -kInfinity, 0.0f, -1.0f}) {
    const Vec3 there = picture.surface.view_position(1, 0, depth);
    EXPECT_EQ(picture.surface.surface_distance(here, normal, there, normal, 1.0f), none) << depth;
    EXPECT_EQ(picture.surface.surface_distance(there, normal, here, normal, 1.0f), none) << depth;
  }
  for (const float odd : {kNan, kInfinity})
    EXPECT_EQ(picture.surface.surface_distance(here, {odd, 0.0f, 1.0f}, picture.point(1, 0), normal, 1.0f), none);
  EXPECT_EQ(picture.surface.same_surface_weight(none), 0.0f);
  EXPECT_EQ(picture.surface.same_surface_weight(1.0f), 1.0f);
  EXPECT_EQ(picture.surface.same_surface_weight(1.25f), 0.75f);
}

}  // namespace
}  // namespace umbrage
