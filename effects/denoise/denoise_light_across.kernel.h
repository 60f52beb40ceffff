// Occlusion and reflected light along rows, from `ao` and `indirect` to `denoise_ao` and `denoise_indirect`.
IN_REAL(ao)
IN_COLOR(indirect)
OUT_REAL(denoise_ao)
OUT_COLOR(denoise_indirect)
#include "effects/denoise/denoise.kernel.h"

FN void denoise_light_across_pixel(Int px, Int py) {
  int step = 1 << F.round;
  float occlusion = F.round < C.rounds ? C.occlusion : 0.0f;
  float indirect = F.round < C.light_rounds ? C.indirect : 0.0f;
  Real depth = near_depth(0, 0);
  Bool surface = is_surface(depth);
  Vec3 position = view_position(px, py, depth);
  Vec3 normal = near_normal(0, 0);
  Real own = clean_ao(near_ao(0, 0));
  Real change = Real(0.0f);
  Real joined = Real(0.0f);
  Vec3 own_light = clean_light(near_indirect(0, 0));
  Vec3 light_change = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  for (int k = -2; k <= 2; ++k) {
    if (k == 0) continue;
    float most = k == -1 || k == 1 ? C.near_weight : C.far_weight;
    Real weight = weight_of(k * step, 0, px, py, position, normal, most);
    change = mad(weight, clean_ao(near_ao(k * step, 0)) - own, change);
    joined = joined + weight;
    light_change = light_change + (clean_light(near_indirect(k * step, 0)) - own_light) * weight;
  }
  Real ao = mad(change, Real(occlusion), own);
  Vec3 light = own_light + light_change * Real(indirect);
  Bool alone = surface && joined < kAlone;
  if (F.round > 0 && some(alone)) {
    alone = alone && is_alone(1, 0, px, py, position, normal);
    Bool has_before = beside(-1, 0);
    Bool has_after = beside(1, 0);
    if (occlusion > 0.0f) {
      Real before = clean_ao(near_ao(-1, 0));
      Real after = clean_ao(near_ao(1, 0));
      ao = select(alone, ao_beside(ao, before, after, has_before, has_after), ao);
    }
    if (indirect > 0.0f) {
      Vec3 before = clean_light(near_indirect(-1, 0));
      Vec3 after = clean_light(near_indirect(1, 0));
      light = select(alone, light_beside(light, before, after, has_before, has_after), light);
    }
  }
  store_denoise_ao(ao);
  store_denoise_indirect(light);
}
