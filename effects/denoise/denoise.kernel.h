// What all passes of `denoise` share: five pixels in a row, [1 2 2 2 1]/8, as far as they lie on one surface; in each
// round twice as far apart, as in the a-trous filter of [Dammertz et al. 2010].
//
// Differs: the weights are a box of 4 times one of 2, not a spline's. What repeats every 4 pixels, as the noise of
// techniques with a 4x4 tile of random vectors does, is gone after one round. And what a neighbour on another surface
// does not give, the pixel itself does, so that two pixels give each other the same and the mean stays.
IN_REAL(depth)
IN_VECTOR(normal)
#include "kernel/surface.kernel.h"

// A pixel that none beside it in its row (column) joins, of a fold or a wire one pixel wide, keeps the noise of its few
// samples. From the second round on, when what is beside it is smooth, it may be so many times as bright as that, and
// so much darker.
CONST float kAlone = 0.02f;  // sum of weights
CONST float kBrighter = 1.35f;
CONST float kDarker = 0.75f;

// The weight of the neighbour (i, j) pixels right and down, of at most `most`: by the distance and the angle that
// people set, up to either of which pixels join fully.
FN Real weight_of(int i, int j, Int px, Int py, Vec3 position, Vec3 normal, float most) {
  Vec3 there = view_position(px + Int(i), py + Int(j), near_depth(i, j));
  Vec3 other_normal = near_normal(i, j);
  Real turned = (1.0f - dot(normal, other_normal)) * Real(C.turn);
  Real joint = joint_of(max(turned, surface_distance(position, normal, there, other_normal, C.distance)));
  // max may overlook what is no number.
  return select(is_finite(turned) && near_inside(i, j), joint * Real(most), Real(0.0f));
}

// The most that the neighbour k steps away weighs, k from -2 to 2.
FN float most_weight(int k) { return k == -1 || k == 1 ? C.near_weight : C.far_weight; }

// Whether neither of the pixels (i, j) to the right and below, and to the left and above, joins this one of a surface.
FN Bool is_alone(int i, int j, Int px, Int py, Vec3 position, Vec3 normal) {
  return weight_of(-i, -j, px, py, position, normal, 1.0f) + weight_of(i, j, px, py, position, normal, 1.0f) < kAlone;
}

FN Bool beside(int i, int j) { return is_surface(near_depth(i, j)) && near_inside(i, j); }

FN Real at_most(Real light, Real before, Real after, Bool has_before, Bool has_after) {
  return min(light, max(select(has_before, before, Real(0.0f)), select(has_after, after, Real(0.0f))) * kBrighter);
}

// Light, held to that of the pixels before and after.
FN Vec3 light_beside(Vec3 light, Vec3 before, Vec3 after, Bool has_before, Bool has_after) {
  Vec3 most = Vec3(at_most(light.x, before.x, after.x, has_before, has_after),
                   at_most(light.y, before.y, after.y, has_before, has_after),
                   at_most(light.z, before.z, after.z, has_before, has_after));
  return select(has_before || has_after, most, light);
}

// Occlusion likewise.
FN Real ao_beside(Real ao, Real before, Real after, Bool has_before, Bool has_after) {
  Real least = min(select(has_before, before, Real(1.0f)), select(has_after, after, Real(1.0f))) * kDarker;
  return select(has_before || has_after, max(ao, least), ao);
}
