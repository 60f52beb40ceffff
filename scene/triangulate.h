// Triangles of polygons and of regions of the plane, by ear clipping [Meisters 1975].
#pragma once
#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "core/progress.h"

namespace umbrage {

/// Splits a polygon of n corners into n - 2 triangles and appends three corner numbers, 0 to n - 1, for each of them.
/// Triangles have the orientation of the polygon. Concave polygons are split correctly, also with collinear or repeated
/// corners and with holes that are connected by a pair of edges; strictly convex ones become a fan around corner 0. The
/// shape is judged in the plane to which the polygon is most parallel. A polygon that crosses itself, has no area or
/// coordinates that are not finite is split somehow, and any polygon once the poll ends. Less than three corners: no
/// triangles.
void split_polygon(std::span<const glm::vec3> corners, std::vector<std::uint32_t>& triangles, Poll* poll = nullptr);

/// A closed polygon: indices of points, the last of which is joined to the first.
using Loop = std::vector<std::uint32_t>;

/// Returns twice the signed area of a loop, positive if it is counterclockwise.
double twice_area(std::span<const glm::dvec2> points, const Loop& loop);

/// Returns triangles, counterclockwise, that fill the region bounded by loops that may touch, but do not cross: where a
/// ray to the outside crosses an odd number of loops, whatever their directions. Their corners are those of the loops
/// that bound the region, and no side of a triangle runs through another corner, so that they share all edges of these
/// loops. Loops that cross, and those of which a corner would take more than 1024 steps, get triangles, too,
/// some of which overlap, have no area or face down. Holes are joined to their polygon by
/// a bridge.
std::vector<std::array<std::uint32_t, 3>> triangulate(std::span<const glm::dvec2> points,
                                                      const std::vector<Loop>& loops);

}  // namespace umbrage
