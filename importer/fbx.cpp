// FBX, by a reader of our own: Assimp 5.2 ignores how scale is inherited, weights of shape keys, the bind pose of skins
// and the front of a file, and versions of Assimp differ in what they convert.
#include <algorithm>

#include "importer/fbx_nodes.h"
#include "importer/fbx_parts.h"
#include "importer/readers.h"

namespace umbrage {

Result<Scene> read_fbx(const std::filesystem::path& path) {
  FbxFile file;
  if (auto status = read_fbx_file(path, file); !status) return status.error();
  Scene scene;
  const std::vector<FbxNode> nodes = place_fbx_nodes(file, scene);
  const std::map<const FbxObject*, int> materials = add_fbx_materials(file, path, scene);
  scene.materials.emplace_back();
  std::map<const FbxObject*, glm::dmat4> worlds;
  for (const FbxNode& node : nodes) worlds[node.model] = node.world_from_node;
  std::set<std::string> warnings;
  std::vector<PlacedMesh> meshes;
  int object = 0;
  const auto add = [&](const FbxNode& node) {
    const glm::dmat4 node_from_geometry = fbx_node_from_geometry(*node.model);
    for (const FbxObject* geometry : node.model->parts("Geometry")) {
      FbxPlace place{.geometry = *geometry,
                     .world_from_geometry = node.world_from_node * node_from_geometry,
                     .node_from_geometry = node_from_geometry,
                     .materials = {},
                     .default_material = int(scene.materials.size()) - 1,
                     .worlds = worlds};
      for (const FbxObject* material : node.model->parts("Material")) place.materials.push_back(materials.at(material));
      for (PlacedMesh& mesh : fbx_meshes(place, warnings)) {
        mesh.mesh.name = node.model->name.empty() ? geometry->name : node.model->name;
        mesh.mesh.object = object;
        meshes.push_back(std::move(mesh));
      }
      ++object;
      if (geometry->subtype != "Mesh") warnings.insert("lines, NURBS and patches in the file are not drawn");
    }
  };
  for (const FbxNode& node : nodes)
    if (node.is_visible) add(node);
  if (meshes.empty()) {
    std::for_each(nodes.begin(), nodes.end(), add);
    if (!meshes.empty()) warnings.insert("all parts of the model are hidden in the file; they are drawn");
  }
  const bool uses_default = std::any_of(meshes.begin(), meshes.end(), [&](const PlacedMesh& each) {
    return each.mesh.material + 1 == int(scene.materials.size());
  });
  if (!uses_default) scene.materials.pop_back();
  move_to_scene(std::move(meshes), scene);
  scene.warnings.insert(scene.warnings.end(), warnings.begin(), warnings.end());
  return scene;
}

}  // namespace umbrage
