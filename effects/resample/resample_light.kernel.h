// Borrows occlusion and indirect light from the first sample.
IN_REAL(other_ao)
IN_COLOR(other_indirect)
OUT_REAL(ao)
OUT_COLOR(indirect)
#include "effects/resample/resample.kernel.h"

// Sums differences to one value, so that a constant stays bitwise identical.
FN void resample_light_pixel(Int px, Int py) {
  Real own = clean_ao(near_other_ao(0, 0));
  Vec3 own_light = clean_light(near_other_indirect(0, 0));
  Real sum = Real(0.0f);
  Real change = Real(0.0f);
  Vec3 light_change = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      Real weight = weight_of(i, j, px, py);
      sum = sum + weight;
      change = mad(weight, clean_ao(near_other_ao(i, j)) - own, change);
      light_change = light_change + (clean_light(near_other_indirect(i, j)) - own_light) * weight;
    }
  Real scale = Real(1.0f) / max(sum, Real(1e-30f));
  store_ao(mad(change, scale, own));
  store_indirect(own_light + light_change * scale);
}
