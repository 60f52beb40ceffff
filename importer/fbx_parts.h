// Parts of the reading of FBX files that importer/fbx.cpp leaves to other files: meshes and materials.
#pragma once
#include <glm/mat4x4.hpp>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "importer/common/placed_mesh.h"
#include "importer/fbx_file.h"
#include "scene/scene.h"

namespace umbrage {

/// A geometry of a file at a node.
struct FbxPlace {
  const FbxObject& geometry;
  glm::dmat4 world_from_geometry, node_from_geometry;
  std::vector<int> materials;                            ///< of the node, by the numbers in the geometry
  int default_material = 0;                              ///< index of the material for polygons without one
  const std::map<const FbxObject*, glm::dmat4>& worlds;  ///< of all nodes
};

/// Returns the meshes of a geometry, one for each material, in the pose of the file: its shape keys have their weights
/// [piecewise linear between the targets of a key], and a skin follows its joints. `warnings`: what is not drawn.
std::vector<PlacedMesh> fbx_meshes(const FbxPlace& place, std::set<std::string>& warnings);

/// Appends the materials of a file and their textures to the scene. Returns their indices.
std::map<const FbxObject*, int> add_fbx_materials(const FbxFile& file, const std::filesystem::path& path, Scene& scene);

}  // namespace umbrage
