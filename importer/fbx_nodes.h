// Models of FBX files as nodes: their transforms to world space, and which of them are seen.
#pragma once
#include <glm/mat4x4.hpp>
#include <vector>

#include "importer/fbx_file.h"
#include "scene/scene.h"

namespace umbrage {

struct FbxNode {
  const FbxObject* model = nullptr;
  glm::dmat4 world_from_node{1.0};
  bool is_visible = true;
};

/// Returns the root and the nodes below it, each parent before its children, and sets the scene's up and front by the
/// axes of the file. Coordinates stay as they are unless models of a file with these axes face another side than
/// usual_front: then, and where the axes are left-handed, +y becomes up and +z the front.
std::vector<FbxNode> place_fbx_nodes(FbxFile& file, Scene& scene);

/// Returns the transform from the space of a model's geometry to that of its node.
glm::dmat4 fbx_node_from_geometry(const FbxObject& model);

}  // namespace umbrage
