// A direction perpendicular to a given one, for coordinate systems about an axis.
#pragma once
#include <cmath>
#include <glm/vec3.hpp>

namespace umbrage {

/// Returns the x axis, or the y axis where the unit vector `axis` is nearly parallel to x. A cross product of the two
/// is perpendicular to `axis`.
template <class T>
glm::vec<3, T> axis_beside(const glm::vec<3, T>& axis) {
  return std::abs(axis.x) < T(0.7) ? glm::vec<3, T>(1, 0, 0) : glm::vec<3, T>(0, 1, 0);
}

}  // namespace umbrage
