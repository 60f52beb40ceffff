// Positions of a file: read in double precision, stored as floats relative to Scene::origin.
#pragma once
#include <cmath>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

#include "scene/scene.h"

namespace umbrage {

inline bool is_finite(const glm::dvec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

/// Finds the origin for a scene: that of nearly all positions, as scene_origin chooses it. One that is far from the
/// rest does not coarsen it.
class OriginFinder {
 public:
  /// Adds a position. Those that are not finite do not count.
  void add(const glm::dvec3& p) {
    if (!is_finite(p)) return;
    low_ = glm::min(low_, p);
    high_ = glm::max(high_, p);
    if (count_++ % step_ == 0) add_sample(p);
  }
  /// Returns the origin; zero without positions.
  glm::dvec3 origin() const;

 private:
  void add_sample(const glm::dvec3& p);

  glm::dvec3 low_{std::numeric_limits<double>::infinity()}, high_{-std::numeric_limits<double>::infinity()};
  std::vector<glm::dvec3> sample_;  ///< every step_-th position
  std::size_t count_ = 0, step_ = 1;
};

/// Sets the positions of the mesh, the first one of the scene, and the scene's origin, which OriginFinder finds.
void set_positions(const std::vector<glm::dvec3>& positions, Mesh& mesh, Scene& scene);

}  // namespace umbrage
