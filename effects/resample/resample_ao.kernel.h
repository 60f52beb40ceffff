// Borrows occlusion from the first sample.
IN_REAL(other_ao)
OUT_REAL(ao)
#include "effects/resample/resample.kernel.h"

// Sums differences to one value, so that a constant stays bitwise identical.
FN void resample_ao_pixel(Int px, Int py) {
  Real own = clean_ao(near_other_ao(0, 0));
  Real sum = Real(0.0f);
  Real change = Real(0.0f);
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      Real weight = weight_of(i, j, px, py);
      sum = sum + weight;
      change = mad(weight, clean_ao(near_other_ao(i, j)) - own, change);
    }
  store_ao(own + change / max(sum, Real(1e-30f)));
}
