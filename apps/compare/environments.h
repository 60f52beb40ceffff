// Environments: skies made in code, whose light the techniques are compared under.
#pragma once
#include <array>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/image.h"
#include "core/light.h"

namespace umbrage {

/// A sky. Its directions are unit vectors: z up, x to the middle of a panorama of it.
struct Environment {
  std::string_view name;
  glm::vec3 (*radiance)(glm::vec3 direction);  ///< linear Rec.709
};

inline constexpr int kEnvironments = 3;
/// Returns a clear sky with a glow about its sun, a studio with three soft lights, and a sunset.
const std::array<Environment, kEnvironments>& environments();

/// Ambient light of an environment: its mean radiance, and the shape, rotated.
struct EnvironmentAmbient {
  glm::vec3 mean{0.0f};
  AmbientShape shape;
};
/// Returns the spherical harmonics of an environment up to the second degree. `axes`: the directions of its x, y and z.
EnvironmentAmbient ambient_of(const Environment& environment, const glm::mat3& axes);

/// Returns the light that a technique gives a white surface: ambient light for its normal times `ao`, plus `indirect`
/// where `picture` has that plane. `normals`: the planes normal.x .y .z, in the space of `ambient`. `names`: those of
/// the result's three planes.
Image environment_light(const Image& picture, const Image& normals, const EnvironmentAmbient& ambient,
                        const std::vector<std::string>& names);

}  // namespace umbrage
