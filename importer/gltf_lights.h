// Lights of glTF files [KHR_lights_punctual].
#pragma once
#include <glm/mat4x4.hpp>
#include <vector>

#include "importer/gltf_file.h"
#include "scene/scene.h"

namespace umbrage {

/// Appends the lights at these nodes to scene.lights, the brightest at the scene's centre first, at most kMaxShadows.
/// Their intensities keep their ratios; together they light the centre as the built-in lights do. The meshes and the
/// origin of the scene must be set. `world`: the transforms of all nodes of the file.
void add_gltf_lights(GltfFile& file, const std::vector<int>& nodes, const std::vector<glm::dmat4>& world, Scene& scene);

}  // namespace umbrage
