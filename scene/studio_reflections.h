// What surfaces mirror in a photo studio besides its lights.
#pragma once
#include <glm/vec3.hpp>
#include <memory>

#include "core/reflection_map.h"

namespace umbrage {

/// Returns the map of a studio with a white backdrop: bright at the horizon, darker and cooler towards the ceiling,
/// darker and warmer towards the floor. It looks the same from every side of the axis `up`.
std::shared_ptr<const ReflectionMap> studio_reflections(const glm::vec3& up);

}  // namespace umbrage
