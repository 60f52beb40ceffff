// Convex solids with rounded edges: armour plates, wedges, gems. The hull of some points, its edges rolled over by a
// ball, so that they catch light as cast and milled edges do.
#pragma once
#include <glm/vec3.hpp>
#include <initializer_list>
#include <span>

#include "scene/scene.h"

namespace umbrage {

/// The convex hull of at least four points that do not all lie in one plane; edges and corners are rounded with radius
/// `bevel` in `segments` steps, and every face stays where it was; without segments edges are sharp. The radius must be
/// positive and less than that of the largest ball inside. Faces are counter-clockwise from outside.
Mesh rounded_hull(std::span<const glm::vec3> points, float bevel, int segments);
inline Mesh rounded_hull(std::initializer_list<glm::vec3> points, float bevel, int segments) {
  return rounded_hull(std::span<const glm::vec3>(points.begin(), points.size()), bevel, segments);
}

}  // namespace umbrage
