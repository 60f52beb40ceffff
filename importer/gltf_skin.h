// Skins and instances of glTF files: the transforms that nodes give to their meshes.
#pragma once
#include <glm/mat4x4.hpp>
#include <vector>

#include "importer/gltf_file.h"

namespace umbrage {

/// Returns, for each joint of a skin, the transform from the space of the mesh to world space. Errors: kFile.
Result<std::vector<glm::dmat4>> transforms_of_skin(GltfFile& file, int skin, const std::vector<glm::dmat4>& world);

/// Returns the transforms of a node's copies, relative to the node [EXT_mesh_gpu_instancing]; one if there are none.
std::vector<glm::dmat4> instances_of(GltfFile& file, const Json& node);

}  // namespace umbrage
