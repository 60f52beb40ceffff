// Borrows the soft shadows of the lights 0 to 2 from the first sample, whose filter needs all pixels.
IN_REAL(first_shadow)
IN_REAL(first_shadow1)
IN_REAL(first_shadow2)
INOUT_REAL(shadow)
INOUT_REAL(shadow1)
INOUT_REAL(shadow2)
#include "effects/resample/resample.kernel.h"

// Sums differences to one value, so that a constant stays bitwise identical.
FN void resample_shadows_pixel(Int px, Int py) {
  Real sum = Real(0.0f);
  Real change0 = Real(0.0f);
  Real change1 = Real(0.0f);
  Real change2 = Real(0.0f);
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      Real weight = weight_of(i, j, px, py);
      sum = sum + weight;
      change0 = mad(weight, near_first_shadow(i, j) - near_first_shadow(0, 0), change0);
      change1 = mad(weight, near_first_shadow1(i, j) - near_first_shadow1(0, 0), change1);
      change2 = mad(weight, near_first_shadow2(i, j) - near_first_shadow2(0, 0), change2);
    }
  Real scale = Real(1.0f) / max(sum, Real(1e-30f));
  if ((C.soft_shadows & 1) != 0) store_shadow(finite_or_zero(mad(change0, scale, near_first_shadow(0, 0))));
  if ((C.soft_shadows & 2) != 0) store_shadow1(finite_or_zero(mad(change1, scale, near_first_shadow1(0, 0))));
  if ((C.soft_shadows & 4) != 0) store_shadow2(finite_or_zero(mad(change2, scale, near_first_shadow2(0, 0))));
}
