// Convex solids with rounded edges: armour plates, wedges, gems. A solid is the convex hull of points, with edges
// rounded by a sphere, so that they catch light as cast and milled edges do.
#pragma once
#include <glm/vec3.hpp>
#include <initializer_list>
#include <span>

#include "scene/scene.h"

namespace umbrage {

/// Makes the convex hull of at least four points that are not all in one plane. Edges and corners are rounded with
/// radius `bevel` in `segments` steps; faces keep their planes. With 0 segments edges are sharp. The radius must be
/// positive and less than that of the largest sphere inside. Faces are counter-clockwise from outside.
Mesh rounded_hull(std::span<const glm::vec3> points, float bevel, int segments);
inline Mesh rounded_hull(std::initializer_list<glm::vec3> points, float bevel, int segments) {
  return rounded_hull(std::span<const glm::vec3>(points.begin(), points.size()), bevel, segments);
}

}  // namespace umbrage
