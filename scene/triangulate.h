// Triangles of a region of the plane that is bounded by closed polygons.
#pragma once
#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

namespace umbrage {

/// A closed polygon: indices of points, the last of which is joined to the first.
using Loop = std::vector<std::uint32_t>;

/// How the inside of a region follows from its loops.
enum class Inside {
  kNonzero,  ///< where the loops' directions add up to a winding number other than 0
  kOdd,      ///< where a ray to the outside crosses an odd number of loops, whatever their directions
};

/// Returns twice the signed area of a loop, positive if it is counterclockwise.
double twice_area(std::span<const glm::dvec2> points, const Loop& loop);

/// Returns triangles, counterclockwise, that fill the region bounded by loops that may touch, but do not cross. Their
/// corners are those of the loops that bound the region, and no side of a triangle runs through another corner, so that
/// they share all edges of these loops. Loops that cross get triangles, too, some of which overlap or face down. By
/// ear clipping, with holes joined to their polygon by a bridge [Meisters 1975]; time grows with the square of the
/// number of points.
std::vector<std::array<std::uint32_t, 3>> triangulate(std::span<const glm::dvec2> points,
                                                      const std::vector<Loop>& loops, Inside inside);

}  // namespace umbrage
