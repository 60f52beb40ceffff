// One dispatch of the filter. The including kernel must define:
//   kAlongRows  whether the filter runs along rows (true) or columns
//   ao_at       returns the `ao` of the pixel (i, j) to the right and below
//   kLight      whether indirect light is filtered, too
//   light_at    returns the light of that pixel (denoise_no_light.kernel.h: none)
#include "effects/denoise/denoise.kernel.h"

struct Filtered {
  Real ao;
  Vec3 light;
};

FN Filtered filtered(Int px, Int py) {
  int step = 1 << F.round;
  int to_right = kAlongRows ? 1 : 0;  // step to the next pixel
  int to_below = kAlongRows ? 0 : 1;
  float occlusion = F.round < C.rounds ? C.occlusion : 0.0f;
  float indirect = kLight && F.round < C.light_rounds ? C.indirect : 0.0f;
  Real depth = near_depth(0, 0);
  Bool surface = is_surface(depth);
  Vec3 position = view_position(px, py, depth);
  Vec3 normal = near_normal(0, 0);
  Real own = ao_at(0, 0);
  Real change = Real(0.0f);
  Real joined = Real(0.0f);
  Vec3 own_light = light_at(0, 0);
  Vec3 light_change = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  for (int k = -2; k <= 2; ++k) {
    if (k == 0) continue;
    int right = k * step * to_right;
    int down = k * step * to_below;
    Real weight = weight_of(right, down, px, py, position, normal, max_weight(k));
    change = mad(weight, ao_at(right, down) - own, change);
    joined = joined + weight;
    if (kLight) light_change = light_change + (light_at(right, down) - own_light) * weight;
  }
  Real ao = mad(change, Real(occlusion), own);
  Vec3 light = own_light;
  if (kLight) light = light + light_change * Real(indirect);
  Bool alone = surface && joined < kMaxIsolatedWeight;
  if (F.round > 0 && some(alone)) {
    alone = alone && is_isolated(to_right, to_below, px, py, position, normal);
    Bool has_before = beside(-to_right, -to_below);
    Bool has_after = beside(to_right, to_below);
    if (occlusion > 0.0f) {
      Real before = ao_at(-to_right, -to_below);
      Real after = ao_at(to_right, to_below);
      ao = select(alone, limited_ao(ao, before, after, has_before, has_after), ao);
    }
    if (indirect > 0.0f) {
      Vec3 before = light_at(-to_right, -to_below);
      Vec3 after = light_at(to_right, to_below);
      light = select(alone, limited_light(light, before, after, has_before, has_after), light);
    }
  }
  return Filtered(ao, light);
}
