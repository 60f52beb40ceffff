// OccluderSet: a few coarse occluders that stand for the surfaces of a scene.
#pragma once
#include <glm/vec3.hpp>
#include <vector>

namespace umbrage {

/// A patch of surface.
struct Occluder {
  glm::vec3 center{0.0f};  ///< centroid of the patch, world space, scene units
  /// Radius of a sphere with the area of the patch, scene units. The cross-section of the sphere is a quarter of the
  /// patch, which is the mean shadow of a convex body with that surface.
  float radius = 0.0f;
  glm::vec3 mean_normal{0.0f};  ///< over the patch, world space: of length 1 where it is flat, 0 where it is closed
  int object = 0;               ///< index of the object among those of the set, from 0
};

/// Sorted by object.
struct OccluderSet {
  std::vector<Occluder> occluders;
  int objects = 0;  ///< number of objects
};

inline constexpr int kMaxOccluders = 256;  ///< of a set

}  // namespace umbrage
