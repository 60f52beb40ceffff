// One pass of the filter over occlusion alone. Passes define before it kAlongRows, whether it runs along rows or along
// columns, and ao_at, the occlusion of the pixel (i, j) to the right and below.
#include "effects/denoise/denoise.kernel.h"

FN Real filtered_ao(Int px, Int py) {
  int step = 1 << F.round;
  int to_right = kAlongRows ? 1 : 0;  // the way to the next pixel
  int to_below = kAlongRows ? 0 : 1;
  Real depth = near_depth(0, 0);
  Bool surface = is_surface(depth);
  Vec3 position = view_position(px, py, depth);
  Vec3 normal = near_normal(0, 0);
  Real own = ao_at(0, 0);
  Real change = Real(0.0f);
  Real joined = Real(0.0f);
  for (int k = -2; k <= 2; ++k) {
    if (k == 0) continue;
    int right = k * step * to_right;
    int down = k * step * to_below;
    Real weight = weight_of(right, down, px, py, position, normal, most_weight(k));
    change = mad(weight, ao_at(right, down) - own, change);
    joined = joined + weight;
  }
  Real ao = mad(change, Real(C.occlusion), own);
  Bool alone = surface && joined < kAlone;
  if (F.round > 0 && C.occlusion > 0.0f && some(alone)) {
    alone = alone && is_alone(to_right, to_below, px, py, position, normal);
    Real before = ao_at(-to_right, -to_below);
    Real after = ao_at(to_right, to_below);
    ao = select(alone, ao_beside(ao, before, after, beside(-to_right, -to_below), beside(to_right, to_below)), ao);
  }
  return ao;
}
