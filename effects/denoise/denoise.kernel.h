// Shared by all dispatches of `denoise`: five taps along a row or column with weights [1 2 2 2 1]/8, as far as they lie
// on one surface. The spacing of the taps doubles in each round, as in the a-trous filter of [Dammertz et al. 2010].
//
// Differs: the weights are a box of 4 convolved with a box of 2, not a spline. They remove noise of period 4, such as
// that of techniques with a 4x4 tile of random vectors, in one round. The weight of a neighbour on another surface goes
// to the pixel itself. So weights are symmetric between two pixels, and the mean is preserved.
IN_REAL(depth)
IN_VECTOR(normal)
#include "kernel/surface.kernel.h"

// A pixel with no neighbour of its surface in its row (column), on a fold or a wire one pixel wide, keeps the noise of
// its few samples. From the second round on, when the pixels beside it are smooth, its indirect light is limited to at
// most kBrighter times theirs, and its `ao` to at least kDarker times theirs.
CONST float kMaxIsolatedWeight = 0.02f;  // max sum of weights of such a pixel
CONST float kBrighter = 1.35f;
CONST float kDarker = 0.75f;

// Returns the weight of the neighbour (i, j) pixels right and down, from 0 to `most`: full up to the distance and the
// angle that users set.
FN Real weight_of(int i, int j, Int px, Int py, Vec3 position, Vec3 normal, float max_value) {
  Vec3 there = view_position(px + Int(i), py + Int(j), near_depth(i, j));
  Vec3 other_normal = near_normal(i, j);
  Real turned = (1.0f - dot(normal, other_normal)) * Real(C.turn);
  Real joint = same_surface_weight(max(turned, surface_distance(position, normal, there, other_normal, C.distance)));
  // max may drop a NaN.
  return select(is_finite(turned) && near_inside(i, j), joint * Real(max_value), Real(0.0f));
}

// Returns the max weight of the tap at k, -2 to 2.
FN float max_weight(int k) { return k == -1 || k == 1 ? C.near_weight : C.far_weight; }

// Returns whether neither the pixel at (i, j) right and down nor that at (-i, -j) lies on the surface of this pixel.
FN Bool is_isolated(int i, int j, Int px, Int py, Vec3 position, Vec3 normal) {
  return weight_of(-i, -j, px, py, position, normal, 1.0f) + weight_of(i, j, px, py, position, normal, 1.0f) <
         kMaxIsolatedWeight;
}

// Returns whether the pixel at (i, j) is inside the picture and shows a surface.
FN Bool beside(int i, int j) { return is_surface(near_depth(i, j)) && near_inside(i, j); }

FN Real limited_channel(Real light, Real before, Real after, Bool has_before, Bool has_after) {
  return min(light, max(select(has_before, before, Real(0.0f)), select(has_after, after, Real(0.0f))) * kBrighter);
}

// Returns light, limited to kBrighter times the brighter of the pixels before and after.
FN Vec3 limited_light(Vec3 light, Vec3 before, Vec3 after, Bool has_before, Bool has_after) {
  Vec3 max_value = Vec3(limited_channel(light.x, before.x, after.x, has_before, has_after),
                        limited_channel(light.y, before.y, after.y, has_before, has_after),
                        limited_channel(light.z, before.z, after.z, has_before, has_after));
  return select(has_before || has_after, max_value, light);
}

// Returns `ao`, limited to at least kDarker times the lower of the pixels before and after.
FN Real limited_ao(Real ao, Real before, Real after, Bool has_before, Bool has_after) {
  Real min_value = min(select(has_before, before, Real(1.0f)), select(has_after, after, Real(1.0f))) * kDarker;
  return select(has_before || has_after, max(ao, min_value), ao);
}
