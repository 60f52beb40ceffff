// Positions of a file: read in double precision, stored as floats relative to Scene::origin.
#pragma once
#include <glm/vec3.hpp>
#include <vector>

#include "scene/scene.h"

namespace umbrage {

/// Sets the positions of the mesh, the first one of the scene, and the scene's origin. The origin is that of nearly all
/// positions: one that is far from the rest does not coarsen it.
void set_positions(const std::vector<glm::dvec3>& positions, Mesh& mesh, Scene& scene);

}  // namespace umbrage
