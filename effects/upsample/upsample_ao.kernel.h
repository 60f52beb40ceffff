// Upsamples occlusion from reduced to full resolution.
#include "effects/upsample/upsample.kernel.h"

// Sums differences from the own block's value, so that equal values stay bitwise identical.
FN void upsample_ao_pixel(Int px, Int py) {
  Vec3 fractions = shares_of(px, py);
  Real own = small_ao(0, 0);
  Real change = change_of_ao(fractions, own);
  Bool few = fractions.x < 0.0f;
  if (some(few) && C.leave == 0) {
    Real sum = Real(0.0f);
    Real wide = Real(0.0f);
    for (int j = -1; j <= 2; ++j)
      for (int i = -1; i <= 2; ++i) {
        Real weight = wide_weight(i, j, px, py);
        sum = sum + weight;
        wide = mad(weight, small_ao(i, j) - own, wide);
      }
    change = select(few, wide * (Real(1.0f) / sum), change);
  }
  Real ao = own + change;
  if (C.leave != 0) ao = select(few, missing_ao(), ao);
  store_ao(ao);
}
