// Meshes that readers place in world space: by the transform of a node, or by the joints of a skin.
#pragma once
#include <functional>
#include <glm/mat4x4.hpp>
#include <vector>

#include "scene/scene.h"

namespace umbrage {

/// A mesh in world space.
struct PlacedMesh {
  Mesh mesh;
  std::vector<glm::dvec3> positions;  ///< in place of mesh.positions; empty: those are world space
};

/// Places a mesh by its node. Its triangles keep their outer side, also where the transform mirrors them.
PlacedMesh placed(Mesh mesh, const glm::dmat4& world_from_mesh);

/// The weighted mean of the transforms of the joints that move a vertex.
struct BlendedTransform {
  glm::dmat4 sum{0.0};
  double weight = 0.0;

  void add(double weight_of_joint, const glm::dmat4& transform) {
    if (!(weight_of_joint > 0.0)) return;
    sum += weight_of_joint * transform;
    weight += weight_of_joint;
  }
  glm::dmat4 mean_or(const glm::dmat4& otherwise) const { return weight > 0.0 ? sum / weight : otherwise; }
};

/// Places a mesh by the joints of a skin. `world_from_vertex`: the transform of each vertex.
PlacedMesh skinned(Mesh mesh, const std::function<glm::dmat4(std::size_t)>& world_from_vertex);

/// Moves the meshes to the scene, relative to an origin near them, which becomes Scene::origin. `motion`: becomes
/// Scene::motion; then the origin is near these points, and the same for all poses.
void move_to_scene(std::vector<PlacedMesh> meshes, Scene& scene, const std::vector<glm::dvec3>& motion = {});

}  // namespace umbrage
