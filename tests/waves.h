// G-buffers for tests of occlusion techniques, and the comparison with a technique's formula.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "support.h"

namespace umbrage::test {

/// Returns a G-buffer of waves with a raised block, a hole, and normals that match them approximately.
inline GBuffer waves(int width, int height, bool orthographic) {
  GBuffer g = test::empty_gbuffer(width, height);
  if (orthographic)
    g.info.camera = orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 4.0f, float(width) / float(height));
  for (const char* name : {"depth", "normal.x", "normal.y", "normal.z"}) g.layers[0].add(name);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double u = 2.0 * (x + 0.5) / width - 1.0, v = 1.0 - 2.0 * (y + 0.5) / height;
      double depth = 6.0 + 0.4 * std::sin(7.0 * u) * std::cos(5.0 * v);
      glm::dvec3 n = glm::normalize(glm::dvec3(0.4 * std::cos(7.0 * u), 0.3 * std::sin(5.0 * v), 1.0));
      if (u > 0.1 && u < 0.4 && v > 0.0 && v < 0.5) {
        depth = 5.2 + 0.1 * u;
        n = {0, 0, 1};
      }
      const bool hole = (u + 0.5) * (u + 0.5) + v * v < 0.02;
      g.layers[0].planes[0].at(x, y) = hole ? std::numeric_limits<float>::infinity() : float(depth);
      for (int k = 0; k < 3; ++k) g.layers[0].planes[1 + k].at(x, y) = hole ? 0.0f : float(n[k]);
    }
  return g;
}

/// Returns the position of a pixel's surface in view space, in double.
inline glm::dvec3 position(const GBuffer& g, int x, int y) {
  const Camera& c = g.info.camera;
  const double depth = g.layers[0].planes[0].at(x, y), spread = c.projection == Projection::kOrthographic ? 1.0 : depth;
  return {(c.left + (double(c.right) - c.left) * (x + 0.5) / g.info.width) * spread,
          (c.top - (double(c.top) - c.bottom) * (y + 0.5) / g.info.height) * spread, -depth};
}

/// Returns the unit normal of a pixel's surface.
inline glm::dvec3 normal(const GBuffer& g, int x, int y) {
  const auto& planes = g.layers[0].planes;
  return glm::normalize(glm::dvec3(planes[1].at(x, y), planes[2].at(x, y), planes[3].at(x, y)));
}

/// Returns the pixel that contains a position of the picture, clamped to the border.
inline glm::ivec2 pixel_at(const GBuffer& g, double x, double y) {
  return {std::clamp(int(std::floor(x)), 0, g.info.width - 1), std::clamp(int(std::floor(y)), 0, g.info.height - 1)};
}

/// Returns a G-buffer filled by a plane that is tilted about the picture's y axis by `tilt` radians, at a depth of 5 in
/// the centre.
inline GBuffer tilted_plane(int width, int height, double tilt) {
  GBuffer g = test::empty_gbuffer(width, height);
  for (const char* name : {"depth", "normal.x", "normal.y", "normal.z"}) g.layers[0].add(name);
  const glm::dvec3 n(std::sin(tilt), 0.0, std::cos(tilt));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double u = (2.0 * (x + 0.5) / width - 1.0) * g.info.camera.right;
      const double depth = 5.0 * n.z / (n.z - n.x * u);
      g.layers[0].planes[0].at(x, y) =
          depth > 0.0 && depth < 1e4 ? float(depth) : std::numeric_limits<float>::infinity();
      for (int k = 0; k < 3; ++k) g.layers[0].planes[1 + k].at(x, y) = float(n[k]);
    }
  return g;
}

/// Expects `ao` to equal the formula of a technique, `truth`, at all but 1 in 200 pixels, since samples on a pixel's
/// border fall to either side. Expects more than `dark_pixels` pixels to be below `dark`.
template <class Truth>
void expect_matches_formula(const GBuffer& g, const Plane& ao, double dark, long dark_pixels, const Truth& truth) {
  long differing = 0, dark_count = 0, compared = 0;
  for (int y = 0; y < ao.height; ++y)
    for (int x = 0; x < ao.width; ++x) {
      if (!std::isfinite(g.layers[0].planes[0].at(x, y))) continue;
      const double expected = truth(x, y);
      differing += std::fabs(ao.at(x, y) - expected) > 2e-4;
      dark_count += expected < dark;
      ++compared;
    }
  EXPECT_LE(differing, compared / 200) << "samples on a pixel's border fall to either side";
  EXPECT_GT(dark_count, dark_pixels);
}

}  // namespace umbrage::test
