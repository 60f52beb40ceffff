// The filter of one dispatch. The kernel that includes it must first define:
//   kAlongRows  whether the filter runs along rows (true) or columns (false)
//   ao_at       returns the `ao` of the pixel (i, j) to the right and below
//   kLight      whether indirect light is filtered too
//   light_at    returns the light of that pixel; 0 without light (denoise_no_light.kernel.h)
#include "effects/denoise/denoise.kernel.h"

struct Filtered {
  Real ao;
  Vec3 light;
};

// Returns the occlusion and light of a pixel after this dispatch.
FN Filtered filtered(Int px, Int py) {
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
  return Filtered(ao, light);
}
