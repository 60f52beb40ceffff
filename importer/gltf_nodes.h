// Nodes of glTF files: their transforms, also at a time of an animation, the scene that they form, and the
// skins and instances that give transforms to meshes.
#pragma once
#include <functional>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "importer/gltf_file.h"

namespace umbrage {

struct GltfNode {
  glm::dvec3 translation{0.0}, scale{1.0};
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
  std::optional<glm::dmat4> matrix;  ///< in place of the other three
  std::vector<float> weights;        ///< of morph targets; empty: those of the mesh
  int parent = -1;
};

/// Returns the nodes of a file, in its order, in the pose of the file.
std::vector<GltfNode> read_nodes(GltfFile& file);

/// Replaces a node's matrix by translation, rotation and scale, without shear.
void split_matrix(GltfNode& node);

/// Returns the transform of each node to world space. A node that is its own ancestor counts as a root.
std::vector<glm::dmat4> world_matrices(const std::vector<GltfNode>& nodes);

/// Returns the nodes of a scene that are visible, each parent before its children. A file without scenes has one, of
/// all roots.
std::vector<int> nodes_of_scene(GltfFile& file, int scene, const std::vector<GltfNode>& nodes);

/// Name and length of an animation.
struct GltfAnimation {
  std::string name;
  float duration_s = 0.0f;
};
std::vector<GltfAnimation> list_animations(GltfFile& file);

/// Moves the nodes to a time of an animation, seconds; before its start and after its end they keep its first and last
/// pose.
using PoseNodes = std::function<void(double time_s, std::vector<GltfNode>& nodes)>;
/// Reads an animation of a file with `node_count` nodes. Channels that are invalid, or that change something else than
/// nodes, cause a warning.
PoseNodes read_animation(GltfFile& file, int animation, std::size_t node_count);

/// Returns, for each joint of a skin, the transform from the space of the mesh to world space. Errors: kFile.
Result<std::vector<glm::dmat4>> transforms_of_skin(GltfFile& file, int skin, const std::vector<glm::dmat4>& world);

/// Returns the transforms of a node's copies, relative to the node [EXT_mesh_gpu_instancing]; one if there are none.
std::vector<glm::dmat4> instances_of(GltfFile& file, const Json& node);

}  // namespace umbrage
