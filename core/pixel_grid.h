// PixelGrid: pixels of a picture, and points in the view space of its camera; in double precision.
#pragma once
#include <cmath>
#include <glm/vec3.hpp>
#include <numbers>

#include "core/camera.h"

namespace umbrage {

/// The rays of a camera's pixels, whose centres are at integers, in view space.
struct PixelGrid {
  double left = 0.0, top = 0.0, step_x = 1.0, step_y = 1.0;
  int width = 1, height = 1;
  bool orthographic = false;

  PixelGrid(const Camera& camera, int pixels_x, int pixels_y)
      : left(camera.left),
        top(camera.top),
        step_x((double(camera.right) - camera.left) / pixels_x),
        step_y((double(camera.top) - camera.bottom) / pixels_y),
        width(pixels_x),
        height(pixels_y),
        orthographic(camera.projection == Projection::kOrthographic) {}
  double u(double x) const { return left + (x + 0.5) * step_x; }
  double v(double y) const { return top - (y + 0.5) * step_y; }
  /// Returns the direction of a pixel of a panorama that shows all longitudes and latitudes.
  glm::dvec3 direction(double x, double y) const {
    const double longitude = 2.0 * std::numbers::pi * (x + 0.5) / width,
                 latitude = std::numbers::pi * (0.5 - (y + 0.5) / height);
    return {std::cos(latitude) * std::sin(longitude), std::sin(latitude), std::cos(latitude) * std::cos(longitude)};
  }
  /// Returns the point that a pixel shows at a depth.
  glm::dvec3 point(double x, double y, double depth) const {
    const double spread = orthographic ? 1.0 : depth;
    return {u(x) * spread, v(y) * spread, -depth};
  }
  /// Returns column, row and depth of a point in the picture.
  glm::dvec3 place(const glm::dvec3& p) const {
    const double spread = orthographic ? 1.0 : -p.z;
    return {(p.x / spread - left) / step_x - 0.5, (top - p.y / spread) / step_y - 0.5, -p.z};
  }
  /// Returns the length of the ray at depth 1.
  double ray(double x, double y) const { return orthographic ? 1.0 : std::sqrt(1.0 + u(x) * u(x) + v(y) * v(y)); }
};

}  // namespace umbrage
