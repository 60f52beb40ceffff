// Implicit surfaces for the rounded figures of the built-in scenes: fields, their blends, and a mesher.
//
// A field is approximately the signed distance to a surface in metres, negative inside. The results of blends are still
// approximate distances; the mesher only needs a gradient near 1, and projects every vertex onto the surface. Distance
// functions after Quilez's collection; the mesher is dual: one vertex per cell that the surface crosses [Gibson 1998,
// surface nets].
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "scene/scene.h"

namespace umbrage::sdf {

using Field = std::function<float(const glm::vec3&)>;

inline float ball(glm::vec3 p, glm::vec3 centre, float radius) { return glm::length(p - centre) - radius; }

/// Returns a first-order approximation of the distance to an ellipsoid. It is exact on the surface.
inline float ellipsoid(glm::vec3 p, glm::vec3 centre, glm::vec3 radii) {
  const glm::vec3 scaled = (p - centre) / radii;
  const float k = glm::length(scaled), slope = glm::length(scaled / radii);
  return slope > 0.0f ? k * (k - 1.0f) / slope : -std::min({radii.x, radii.y, radii.z});
}

/// Returns the distance to a capsule whose radius is interpolated between its ends.
inline float bar(glm::vec3 p, glm::vec3 a, glm::vec3 b, float radius_a, float radius_b) {
  const glm::vec3 along = b - a;
  const float t = std::clamp(glm::dot(p - a, along) / glm::dot(along, along), 0.0f, 1.0f);
  return glm::length(p - a - t * along) - (radius_a + (radius_b - radius_a) * t);
}

/// Returns the distance to a box of half size `half` with edges rounded by `round`.
inline float box(glm::vec3 p, glm::vec3 centre, glm::vec3 half, float round) {
  const glm::vec3 out = glm::abs(p - centre) - half + round;
  return glm::length(glm::max(out, 0.0f)) + std::min(std::max({out.x, out.y, out.z}), 0.0f) - round;
}

/// Return the union, intersection and difference of two fields, with seams rounded over about the width `blend`.
inline float join(float a, float b, float blend) {
  const float h = std::max(blend - std::abs(a - b), 0.0f) / blend;
  return std::min(a, b) - 0.25f * h * h * blend;
}
inline float overlap(float a, float b, float blend) { return -join(-a, -b, blend); }
inline float cut(float from, float tool, float blend) { return -join(-from, tool, blend); }

/// Makes a mesh with smooth normals of the surface of a field inside a box. The field must be positive on the box's
/// sides. `cell` is the approximate edge length of the triangles; the mesh has about 3 triangles per cell^2 of surface.
Mesh mesh(const Field& field, glm::vec3 low, glm::vec3 high, float cell);

}  // namespace umbrage::sdf
