// Borrows the soft shadow of one light from the first sample, whose filter needs all pixels.
// KERNEL resample_shadow0: SHADOW=shadow FIRST=other_shadow
// KERNEL resample_shadow1: SHADOW=shadow1 FIRST=other_shadow1
// KERNEL resample_shadow2: SHADOW=shadow2 FIRST=other_shadow2
// KERNEL resample_shadow3: SHADOW=shadow3 FIRST=other_shadow3
// KERNEL resample_shadow4: SHADOW=shadow4 FIRST=other_shadow4
// KERNEL resample_shadow5: SHADOW=shadow5 FIRST=other_shadow5
// KERNEL resample_shadow6: SHADOW=shadow6 FIRST=other_shadow6
// KERNEL resample_shadow7: SHADOW=shadow7 FIRST=other_shadow7
IN_REAL_AS(first, FIRST)
OUT_REAL_AS(new_shadow, SHADOW)
#include "effects/resample/resample.kernel.h"

// Sums differences to one value, so that a constant stays bitwise identical.
FN void resample_shadow_pixel(Int px, Int py) {
  Real own = near_first(0, 0);
  Real sum = Real(0.0f);
  Real change = Real(0.0f);
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      Real weight = weight_of(i, j, px, py);
      sum = sum + weight;
      change = mad(weight, near_first(i, j) - own, change);
    }
  Real scale = Real(1.0f) / max(sum, Real(1e-30f));
  store_new_shadow(finite_or_zero(mad(change, scale, own)));
}
