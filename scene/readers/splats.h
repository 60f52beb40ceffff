// Gaussian splats [Kerbl et al. 2023] as opaque discs and spheres.
#pragma once
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "scene/scene.h"

namespace umbrage {

/// One Gaussian, with the values of its file.
struct Splat {
  glm::vec3 harmonics;  ///< coefficients of degree 0 of the colour's spherical harmonics
  float opacity;        ///< before the sigmoid
  glm::vec3 log_scale;  ///< logarithms of the standard deviations
  glm::vec4 rotation;   ///< quaternion: w, x, y, z
};

/// Replaces the only mesh of a scene, whose positions are the Gaussians' centres, by points with colours and radii:
/// discs along the two longer axes of flat Gaussians, spheres for others. Gaussians with an opacity below 0.3 are left
/// out. Adds a warning that says what is not drawn.
void draw_splats(const std::vector<Splat>& splats, Scene& scene);

}  // namespace umbrage
