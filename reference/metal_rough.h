// Reflection by the metallic-roughness material of glTF 2.0, appendix B. For comparison with effects/lighting it shares
// no code with it.
#pragma once
#include <functional>
#include <glm/vec3.hpp>

#include "reference/sampler.h"

namespace umbrage {

/// A surface and its material. Directions are unit; the camera sees the front.
struct MetalRough {
  glm::vec3 normal, to_eye;
  glm::vec3 base{1.0f};
  float metallic = 0.0f, roughness = 1.0f;
};

/// Returns the radiance towards the camera under parallel light from `to_light`, of which a white diffuse surface that
/// faces it has the radiance 1: pi times the BRDF times the cosine.
glm::vec3 reflected_light(const MetalRough& surface, glm::vec3 to_light);

/// Returns the radiance towards the camera under light of this radiance from every direction, without occlusion, by
/// `samples` directions of the lobe and as many of the cosine, weighted by the balance heuristic [Veach and Guibas
/// 1995].
glm::vec3 reflected_environment(const MetalRough& surface, const std::function<glm::vec3(glm::vec3)>& radiance,
                                const SampleTable& table, int samples, std::uint32_t seed);

}  // namespace umbrage
