// Shared by all dispatches of `denoise`: five taps along a row or column with weights [1 2 2 2 1]/8, if they are on one
// surface. The spacing of the taps doubles in each round, as in the a-trous filter of [Dammertz et al. 2010].
//
// Differs: the weights are a box of 4 convolved with a box of 2, not a spline. One round removes noise of period 4,
// such as that of techniques with a 4x4 tile of random vectors. The pixel itself gets the weight of a neighbour on
// another surface; so two pixels give each other equal weight, and the mean is preserved.
#include "kernel/joint.kernel.h"

// A pixel is isolated if no neighbour in its row (or column) is on its surface, as on a fold or a wire one pixel wide.
// The filter cannot smooth it. From the second round on, when the pixels beside it are smooth, its indirect light is
// limited to at most kMaxBrighter times theirs, and its `ao` to at least kMaxDarker times theirs.
CONST float kMaxIsolatedWeight = 0.02f;  // max sum of the weights of an isolated pixel's neighbours
CONST float kMaxBrighter = 1.35f;
CONST float kMaxDarker = 0.75f;

// Returns the weight of the pixel (i, j) to the right and below, from 0 to `full_weight`. It is full up to the distance
// and the angle that users set.
FN Real weight_of(int i, int j, Int px, Int py, Vec3 position, Vec3 normal, float full_weight) {
  return joint_weight(i, j, px, py, position, normal, C.distance, C.turn) * Real(full_weight);
}

// Returns the max weight of tap k, which is -2, -1, 1 or 2.
FN float max_weight(int k) { return k == -1 || k == 1 ? C.near_weight : C.far_weight; }

// Returns whether neither the pixel (i, j) to the right and below nor that opposite to it is on the pixel's surface.
FN Bool is_isolated(int i, int j, Int px, Int py, Vec3 position, Vec3 normal) {
  return weight_of(-i, -j, px, py, position, normal, 1.0f) + weight_of(i, j, px, py, position, normal, 1.0f) <
         kMaxIsolatedWeight;
}

// Returns whether the pixel (i, j) to the right and below is inside the picture and shows a surface.
FN Bool shows_surface(int i, int j) { return is_surface(near_depth(i, j)) && near_inside(i, j); }

// Returns one channel of limited_light(), if there is a pixel before or after.
FN Real limited_channel(Real light, Real before, Real after, Bool has_before, Bool has_after) {
  return min(light, max(select(has_before, before, Real(0.0f)), select(has_after, after, Real(0.0f))) * kMaxBrighter);
}

// Returns light, limited to kMaxBrighter times that of the brighter of the pixels before and after; unchanged if
// neither exists.
FN Vec3 limited_light(Vec3 light, Vec3 before, Vec3 after, Bool has_before, Bool has_after) {
  Vec3 limited = Vec3(limited_channel(light.x, before.x, after.x, has_before, has_after),
                      limited_channel(light.y, before.y, after.y, has_before, has_after),
                      limited_channel(light.z, before.z, after.z, has_before, has_after));
  return select(has_before || has_after, limited, light);
}

// Returns `ao`, limited to at least kMaxDarker times the lower one of the pixels before and after; unchanged if neither
// exists.
FN Real limited_ao(Real ao, Real before, Real after, Bool has_before, Bool has_after) {
  Real min_ao = min(select(has_before, before, Real(1.0f)), select(has_after, after, Real(1.0f))) * kMaxDarker;
  return select(has_before || has_after, max(ao, min_ao), ao);
}
