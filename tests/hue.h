// Hue and saturation of a colour, as HSV defines them on display values.
#pragma once
#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>

namespace umbrage::test {

struct HueAndSaturation {
  double hue_deg, saturation;
};

/// `color`: display values; not grey.
inline HueAndSaturation hue_and_saturation(const glm::dvec3& color) {
  const double max = std::max({color.r, color.g, color.b}), range = max - std::min({color.r, color.g, color.b});
  const double sextant = max == color.r   ? (color.g - color.b) / range
                         : max == color.g ? 2.0 + (color.b - color.r) / range
                                          : 4.0 + (color.r - color.g) / range;
  return {60.0 * sextant, range / max};
}

/// Returns the angle between two hues, 0 to 180 degrees.
inline double angle_between_deg(double a, double b) { return std::fabs(std::remainder(a - b, 360.0)); }

}  // namespace umbrage::test
