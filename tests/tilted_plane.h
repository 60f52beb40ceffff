// A plane at a grazing angle, with or without a step, in either projection, for tests of the code that decides whether
// two pixels show the same surface.
#pragma once
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/gbuffer.h"
#include "support.h"

namespace umbrage::test {

struct TiltedPlane {
  double angle_deg = 85.0;  // from its normal to the line of sight in the centre of the picture
  bool orthographic = false;
  int width = 64, height = 64;
  double scale = 1.0;        // scale of the scene
  double step_px = 0.0;      // from the middle column on: offset towards the camera, in pixel sizes
  double error_deg = 0.0;    // amplitude by which normals oscillate about the plane's, as interpolated ones do
  double roll_rad = 0.5;     // direction of the tilt; 0: depth changes only along columns
  double depth_ratio = 0.4;  // relative difference of depth between the centre and the upper or lower border
};

inline constexpr double kGrazingAngles[] = {85.0, 87.0, 89.0};

/// Returns a G-buffer with the depth and normals of a plane.
inline GBuffer seen(const TiltedPlane& plane) {
  GBuffer g = empty_gbuffer(plane.width, plane.height);
  const double angle = plane.angle_deg * std::numbers::pi / 180.0, depth = 5.0 * plane.scale;
  // In the direction of the tilt, depth grows by the tangent of the angle.
  const double half = plane.depth_ratio / std::tan(angle) * (plane.orthographic ? depth : 1.0);
  const double pixel = 2.0 * half / plane.height;
  Camera& camera = g.info.camera;
  camera.projection = plane.orthographic ? Projection::kOrthographic : Projection::kPerspective;
  camera.top = float(half);
  camera.bottom = -camera.top;
  camera.right = float(half * plane.width / plane.height);
  camera.left = -camera.right;
  const auto normal = [&](double deg, double out[3]) {
    const double a = std::min(deg, 89.9) * std::numbers::pi / 180.0;  // normals face the camera
    out[0] = std::sin(a) * std::sin(plane.roll_rad);
    out[1] = std::sin(a) * std::cos(plane.roll_rad);
    out[2] = std::cos(a);
  };
  double n[3], noisy_normal[3];
  normal(plane.angle_deg, n);
  Image& image = g.layers[0];
  for (const char* name : {"depth", "normal.x", "normal.y", "normal.z"}) image.add(name);
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x) {
      const double u = camera.left + (x + 0.5) * pixel, v = camera.top - (y + 0.5) * pixel;
      const double size = pixel * (plane.orthographic ? 1.0 : depth);
      const double offset = 2 * x >= plane.width ? plane.step_px * size : 0.0;
      const double lean = n[0] * u + n[1] * v;
      image.planes[0].at(x, y) =
          float(plane.orthographic ? depth + (lean - offset) / n[2] : (depth * n[2] - offset) / (n[2] - lean));
      normal(plane.angle_deg + plane.error_deg * std::sin(0.15 * x + 0.2 * y), noisy_normal);
      for (int c = 0; c < 3; ++c) image.planes[std::size_t(1 + c)].at(x, y) = float(noisy_normal[c]);
    }
  return g;
}

/// Calls `check` for every angle, both projections and several scales of the scene.
template <class Check>
void at_grazing_angles(const TiltedPlane& base, const Check& check) {
  for (const bool orthographic : {false, true})
    for (const double angle_deg : kGrazingAngles)
      for (const double scale : {1e-3, 1.0, 1e3}) {
        SCOPED_TRACE(
            fmt::format("{} degrees, {}, scale {}", angle_deg, orthographic ? "orthographic" : "perspective", scale));
        TiltedPlane plane = base;
        plane.angle_deg = angle_deg;
        plane.orthographic = orthographic;
        plane.scale = scale;
        check(plane);
      }
}

}  // namespace umbrage::test
