// Occlusion and reflected light along columns, from `denoise_ao` and `denoise_indirect` to `ao` and `indirect`.
IN_REAL(denoise_ao)
IN_COLOR(denoise_indirect)
OUT_REAL(ao)
OUT_COLOR(indirect)
#include "effects/denoise/denoise.kernel.h"

FN void denoise_light_down_pixel(Int px, Int py) {
  int step = 1 << F.round;
  float occlusion = F.round < C.rounds ? C.occlusion : 0.0f;
  float indirect = F.round < C.light_rounds ? C.indirect : 0.0f;
  Real depth = near_depth(0, 0);
  Bool surface = is_surface(depth);
  Vec3 position = view_position(px, py, depth);
  Vec3 normal = near_normal(0, 0);
  Real own = clean_ao(near_denoise_ao(0, 0));
  Real change = Real(0.0f);
  Real joined = Real(0.0f);
  Vec3 own_light = clean_light(near_denoise_indirect(0, 0));
  Vec3 light_change = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  for (int k = -2; k <= 2; ++k) {
    if (k == 0) continue;
    float most = k == -1 || k == 1 ? C.near_weight : C.far_weight;
    Real weight = weight_of(0, k * step, px, py, position, normal, most);
    change = mad(weight, clean_ao(near_denoise_ao(0, k * step)) - own, change);
    joined = joined + weight;
    light_change = light_change + (clean_light(near_denoise_indirect(0, k * step)) - own_light) * weight;
  }
  Real ao = mad(change, Real(occlusion), own);
  Vec3 light = own_light + light_change * Real(indirect);
  Bool alone = surface && joined < kAlone;
  if (F.round > 0 && some(alone)) {
    alone = alone && is_alone(0, 1, px, py, position, normal);
    Bool has_before = beside(0, -1);
    Bool has_after = beside(0, 1);
    if (occlusion > 0.0f) {
      Real before = clean_ao(near_denoise_ao(0, -1));
      Real after = clean_ao(near_denoise_ao(0, 1));
      ao = select(alone, ao_beside(ao, before, after, has_before, has_after), ao);
    }
    if (indirect > 0.0f) {
      Vec3 before = clean_light(near_denoise_indirect(0, -1));
      Vec3 after = clean_light(near_denoise_indirect(0, 1));
      light = select(alone, light_beside(light, before, after, has_before, has_after), light);
    }
  }
  store_ao(ao);
  store_indirect(light);
}
