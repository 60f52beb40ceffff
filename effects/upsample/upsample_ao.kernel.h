// Upsamples occlusion from reduced to full resolution.
#include "effects/upsample/upsample.kernel.h"

// Sums differences to the own block's value, so that a constant stays bitwise identical.
FN void upsample_ao_pixel(Int px, Int py) {
  Vec3 weights = corner_weights(px, py);
  Real own = ao_of_block(0, 0);
  Real change = change_of_ao(weights, own);
  Bool too_few = weights.x < 0.0f;
  if (some(too_few) && C.leave == 0) {
    Real sum = Real(0.0f);
    Real wide = Real(0.0f);
    for (int j = -1; j <= 2; ++j)
      for (int i = -1; i <= 2; ++i) {
        Real weight = wide_weight(i, j, px, py);
        sum = sum + weight;
        wide = mad(weight, ao_of_block(i, j) - own, wide);
      }
    change = select(too_few, wide * (Real(1.0f) / sum), change);
  }
  Real ao = own + change;
  if (C.leave != 0) ao = select(too_few, missing_ao(), ao);
  store_ao(ao);
}
