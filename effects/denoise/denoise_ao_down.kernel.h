// Occlusion along columns, from `denoise_ao` to `ao`.
IN_REAL(denoise_ao)
OUT_REAL(ao)
#include "effects/denoise/denoise.kernel.h"

FN void denoise_ao_down_pixel(Int px, Int py) {
  int step = 1 << F.round;
  Real depth = near_depth(0, 0);
  Bool surface = is_surface(depth);
  Vec3 position = view_position(px, py, depth);
  Vec3 normal = near_normal(0, 0);
  Real own = clean_ao(near_denoise_ao(0, 0));
  Real change = Real(0.0f);
  Real joined = Real(0.0f);
  for (int k = -2; k <= 2; ++k) {
    if (k == 0) continue;
    float most = k == -1 || k == 1 ? C.near_weight : C.far_weight;
    Real weight = weight_of(0, k * step, px, py, position, normal, most);
    change = mad(weight, clean_ao(near_denoise_ao(0, k * step)) - own, change);
    joined = joined + weight;
  }
  Real ao = mad(change, Real(C.occlusion), own);
  Bool alone = surface && joined < kAlone;
  if (F.round > 0 && C.occlusion > 0.0f && some(alone)) {
    alone = alone && is_alone(0, 1, px, py, position, normal);
    Real before = clean_ao(near_denoise_ao(0, -1));
    Real after = clean_ao(near_denoise_ao(0, 1));
    ao = select(alone, ao_beside(ao, before, after, beside(0, -1), beside(0, 1)), ao);
  }
  store_ao(ao);
}
