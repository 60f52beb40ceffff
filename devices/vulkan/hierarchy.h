// Hierarchy: the primitives of a scene in a binary tree of boxes, for traversal by capture.comp.
#pragma once
#include <array>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "core/progress.h"
#include "core/result.h"
#include "scene/scene.h"

namespace umbrage {

/// Nodes and triangles as four vectors each; integers are stored as the bits of floats.
struct Hierarchy {
  /// For each inner node, the lower and the upper corner of the boxes of both children. The fourth component of a lower
  /// corner is the child: the index of a node, or ~(8 first + count) for a leaf of `count` triangles from `first` on.
  std::vector<std::array<glm::vec4, 4>> nodes;
  /// Triangles and points in the order of the leaves. Of a triangle, the three corners, whose fourth components are the
  /// mesh and the indices of the first and second corner among all vertices of the scene; then the index of the third
  /// corner, and kTriangle. For points see capture_scene.glsl.
  std::vector<std::array<glm::vec4, 4>> triangles;
  int root = 0;  ///< encoded like a child in `nodes`

  bool empty() const { return triangles.empty(); }
};

/// Builds the hierarchy of a scene moved by -center and scaled. Uses Embree's builder, and all threads of the calling
/// task arena. Errors: kDevice if it runs out of memory; kInterrupted.
Result<Hierarchy> build_hierarchy(const Scene& scene, glm::vec3 center, float scale,
                                  const ProgressMonitor& monitor = {});

}  // namespace umbrage
