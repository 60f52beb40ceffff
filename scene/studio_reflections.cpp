#include "scene/studio_reflections.h"

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace umbrage {

std::shared_ptr<const ReflectionMap> studio_reflections(const glm::vec3& up) {
  // Relative to white under the key light. The backdrop is lit separately, as usual, and brighter than ambient light.
  constexpr glm::vec3 kCeiling(0.13f, 0.145f, 0.165f), kBackdrop(0.62f, 0.62f, 0.62f), kFloor(0.21f, 0.2f, 0.185f);
  constexpr float kCeilingHeight = 0.7f, kFloorDepth = 0.45f;  // sine of the elevation from which on the colour is even
  const glm::vec3 vertical = glm::normalize(up);
  return std::make_shared<const ReflectionMap>(reflection_map([&](glm::vec3 direction) {
    const float height = glm::dot(direction, vertical);
    return height > 0.0f ? glm::mix(kBackdrop, kCeiling, glm::smoothstep(0.0f, kCeilingHeight, height))
                         : glm::mix(kBackdrop, kFloor, glm::smoothstep(0.0f, kFloorDepth, -height));
  }));
}

}  // namespace umbrage
