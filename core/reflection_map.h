// Reflection map: the light that arrives from all directions, averaged over the lobes of rough surfaces. The first sum
// of the split-sum approximation [Karis 2013, "Environment Map Lighting"].
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <memory>

#include "core/light.h"

namespace umbrage {

/// Returns the map of light whose radiance from a unit direction is `radiance`, averaged over GGX lobes.
ReflectionMap reflection_map(const std::function<glm::vec3(glm::vec3)>& radiance);

/// Returns the map of ambient light: of the smoothest radiance that lights diffuse surfaces so.
ReflectionMap reflection_map(glm::vec3 ambient, const AmbientShape& shape);

/// The second sum of the split-sum approximation, for GGX with height-correlated masking: a surface of reflectance F0
/// at normal incidence reflects scale F0 + bias of uniform light towards a camera.
struct EnvironmentBrdf {
  static constexpr int kSide = 12;
  /// Row by row: roughness from 0 to 1 across, cosine of the angle to the normal from 0 to 1 down.
  std::array<float, std::size_t(kSide*kSide)> scale{}, bias{};
};
const EnvironmentBrdf& environment_brdf();

/// Returns what surfaces mirror in a photo studio besides its lights: the map of a studio with a white backdrop: bright
/// at the horizon, darker and cooler towards the ceiling, darker and warmer towards the floor. It looks the same from
/// every side of the axis `up`.
std::shared_ptr<const ReflectionMap> studio_reflections(const glm::vec3& up);

}  // namespace umbrage
