// The joint weight of two pixels in a filter: 1 on the same surface, 0 on another, for kernels that average over a
// surface.
//
// A pixel is on the surface of another if its point is near the other's plane, and the other way round, and their
// normals differ little. Planes alone would join the two sides of a fold, and normals alone two parallel walls.
//
// It declares the inputs `depth` and `normal`.

#include "kernel/surface.kernel.h"

IN_REAL(depth)
IN_VECTOR(normal)

// Returns the weight of the pixel (i, j) to the right and below. It is 1 while that pixel is at most `distance` pixel
// sizes off the plane of this one and the angle between their normals is at most that for which `turn` is 1 / (1 - its
// cosine). It is 0 from twice that on, and outside the picture.
FN Real joint_weight(int i, int j, Int px, Int py, Vec3 position, Vec3 normal, float distance, float turn) {
  Vec3 position_there = view_position(px + Int(i), py + Int(j), near_depth(i, j));
  Vec3 other_normal = near_normal(i, j);
  Real angle_distance = (1.0f - dot(normal, other_normal)) * Real(turn);
  Real weight = same_surface_weight(
      max(angle_distance, surface_distance(position, normal, position_there, other_normal, distance)));
  // The test is needed since max() may ignore a NaN.
  return select(is_finite(angle_distance) && near_inside(i, j), weight, Real(0.0f));
}
