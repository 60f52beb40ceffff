// Filters occlusion, and indirect light with LIGHT, along rows or columns: five taps with weights [1 2 2 2 1]/8, if
// they are on one surface. The spacing of the taps doubles in each round, as in the a-trous filter of [Dammertz et al.
// 2010].
//
// Differs: the weights are a box of 4 convolved with a box of 2, not a spline. One round removes noise of period 4,
// such as that of techniques with a 4x4 tile of random vectors. The pixel itself gets the weight of a neighbour on
// another surface; so two pixels give each other equal weight, and the mean is preserved.
// KERNEL denoise_ao_across: ALONG_ROWS=1 LIGHT=0 AO=ao NEW_AO=denoise_ao
// KERNEL denoise_ao_down: ALONG_ROWS=0 LIGHT=0 AO=denoise_ao NEW_AO=ao
// KERNEL denoise_light_across: ALONG_ROWS=1 LIGHT=1 AO=ao NEW_AO=denoise_ao INDIRECT=indirect NEW_INDIRECT=denoise_indirect
// KERNEL denoise_light_down: ALONG_ROWS=0 LIGHT=1 AO=denoise_ao NEW_AO=ao INDIRECT=denoise_indirect NEW_INDIRECT=indirect
IN_REAL_AS(source_ao, AO)
OUT_REAL_AS(new_ao, NEW_AO)
IN_COLOR_IF(LIGHT, source_light, INDIRECT)
OUT_COLOR_IF(LIGHT, new_light, NEW_INDIRECT)
CONST bool kAlongRows = ALONG_ROWS == 1;
CONST bool kLight = LIGHT == 1;

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

// Return the `ao` and the indirect light of the pixel (i, j) to the right and below.
FN Real ao_at(int i, int j) { return clean_ao(near_source_ao(i, j)); }
FN Vec3 light_at(int i, int j) { return clean_light(near_source_light(i, j)); }

FN void denoise_pixel(Int px, Int py) {
  int step = 1 << F.round;
  int to_right = kAlongRows ? 1 : 0;  // to the next pixel
  int to_below = kAlongRows ? 0 : 1;
  float occlusion = F.round < C.rounds ? C.occlusion : 0.0f;
  float indirect = kLight && F.round < C.light_rounds ? C.indirect : 0.0f;
  Real depth = near_depth(0, 0);
  Bool surface = is_surface(depth);
  Vec3 position = view_position(px, py, depth);
  Vec3 normal = near_normal(0, 0);
  Real own_ao = ao_at(0, 0);
  Real ao_change = Real(0.0f);
  Real weight_sum = Real(0.0f);
  Vec3 own_light = light_at(0, 0);
  Vec3 light_change = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  for (int k = -2; k <= 2; ++k) {
    if (k == 0) continue;
    int right = k * step * to_right;
    int down = k * step * to_below;
    Real weight = weight_of(right, down, px, py, position, normal, max_weight(k));
    ao_change = mad(weight, ao_at(right, down) - own_ao, ao_change);
    weight_sum = weight_sum + weight;
    if (kLight) light_change = light_change + (light_at(right, down) - own_light) * weight;
  }
  Real ao = mad(ao_change, Real(occlusion), own_ao);
  Vec3 light = own_light;
  if (kLight) light = light + light_change * Real(indirect);
  Bool isolated = surface && weight_sum < kMaxIsolatedWeight;
  if (F.round > 0 && some(isolated)) {
    isolated = isolated && is_isolated(to_right, to_below, px, py, position, normal);
    Bool has_before = shows_surface(-to_right, -to_below);
    Bool has_after = shows_surface(to_right, to_below);
    if (occlusion > 0.0f) {
      Real before = ao_at(-to_right, -to_below);
      Real after = ao_at(to_right, to_below);
      ao = select(isolated, limited_ao(ao, before, after, has_before, has_after), ao);
    }
    if (indirect > 0.0f) {
      Vec3 before = light_at(-to_right, -to_below);
      Vec3 after = light_at(to_right, to_below);
      light = select(isolated, limited_light(light, before, after, has_before, has_after), light);
    }
  }
  store_new_ao(ao);
  store_new_light(light);
}
