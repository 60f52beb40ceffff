// Makes the coarse occluders of a scene: clusters of its surfaces, as in the sphere sets of
// [Shanmugam and Arikan 2007].
#pragma once
#include <memory>

#include "core/gbuffer.h"
#include "scene/scene.h"

namespace umbrage {

/// Returns at most `count` occluders, 1 to kMaxOccluders, each a patch of one object: a cluster of its surface by
/// position and normal. All areas together are the area of the scene. Objects get occluders by the square root of their
/// area, each at least one; a scene with more than `count` objects counts as one object. Triangles face the side of
/// their vertex normals. A disc of a point cloud counts half, since discs overlap. Blended surfaces are left out. The
/// result does not depend on the number of threads. It is empty if the scene has no surface.
OccluderSet make_occluders(const Scene& scene, int count);

/// The last set that a device made for its scene.
struct MadeOccluders {
  int count = 0;
  std::shared_ptr<const OccluderSet> set;
};

/// Returns the set with `count` occluders, from `made` if it has that count; null for a count of 0. Whoever prepares
/// another scene clears `made`.
std::shared_ptr<const OccluderSet> occluders_of(const Scene& scene, int count, MadeOccluders& made);

}  // namespace umbrage
