// Directions for rays: an orthonormal basis around an axis, and distributions of directions about +z.
#pragma once
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <numbers>

namespace umbrage {

/// Returns an orthonormal basis with z = n, continuous except at n.z = 0 [Duff et al. 2017].
inline glm::mat3 basis_around(glm::vec3 n) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1.0f / (sign + n.z), b = n.x * n.y * a;
  return {{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

/// Returns a direction about +z with a probability density proportional to its cosine: a point of the disc, by the
/// concentric map, which keeps neighbouring samples close [Shirley and Chiu 1997], projected to the sphere. `sample` is
/// strictly inside the unit square.
inline glm::vec3 cosine_direction(glm::vec2 sample) {
  constexpr float kQuarter = std::numbers::pi_v<float> / 4.0f;
  const float a = 2.0f * sample.x - 1.0f, b = 2.0f * sample.y - 1.0f;
  float radius = 0.0f, angle = 0.0f;
  if (std::abs(a) > std::abs(b)) {
    radius = a;
    angle = kQuarter * (b / a);
  } else if (b != 0.0f) {
    radius = b;
    angle = 2.0f * kQuarter - kQuarter * (a / b);
  }
  // No sample is on the disc's edge, so z > 0. (1 - r) (1 + r) keeps it above 0; 1 - x x - y y may round to 0.
  return {radius * std::cos(angle), radius * std::sin(angle), std::sqrt((1.0f - radius) * (1.0f + radius))};
}

/// Returns a direction about +z within a cone, uniform in solid angle. `cone_height` is 1 minus the cosine of its half
/// angle, which floats represent even for the narrowest cone.
inline glm::vec3 cone_direction(glm::vec2 sample, float cone_height) {
  const float below = sample.x * cone_height;
  const float across = std::sqrt(below * (2.0f - below)), angle = 2.0f * std::numbers::pi_v<float> * sample.y;
  return {across * std::cos(angle), across * std::sin(angle), 1.0f - below};
}

}  // namespace umbrage
