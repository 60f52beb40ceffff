// Borrows the soft shadows of the lights 3 to 7 from the first sample, whose filter needs all pixels.
IN_REAL(first_shadow3)
IN_REAL(first_shadow4)
IN_REAL(first_shadow5)
IN_REAL(first_shadow6)
IN_REAL(first_shadow7)
INOUT_REAL(shadow3)
INOUT_REAL(shadow4)
INOUT_REAL(shadow5)
INOUT_REAL(shadow6)
INOUT_REAL(shadow7)
#include "effects/resample/resample.kernel.h"

// Sums differences to one value, so that a constant stays bitwise identical.
FN void resample_more_shadows_pixel(Int px, Int py) {
  Real sum = Real(0.0f);
  Real change3 = Real(0.0f);
  Real change4 = Real(0.0f);
  Real change5 = Real(0.0f);
  Real change6 = Real(0.0f);
  Real change7 = Real(0.0f);
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      Real weight = weight_of(i, j, px, py);
      sum = sum + weight;
      change3 = mad(weight, near_first_shadow3(i, j) - near_first_shadow3(0, 0), change3);
      change4 = mad(weight, near_first_shadow4(i, j) - near_first_shadow4(0, 0), change4);
      change5 = mad(weight, near_first_shadow5(i, j) - near_first_shadow5(0, 0), change5);
      change6 = mad(weight, near_first_shadow6(i, j) - near_first_shadow6(0, 0), change6);
      change7 = mad(weight, near_first_shadow7(i, j) - near_first_shadow7(0, 0), change7);
    }
  Real scale = Real(1.0f) / max(sum, Real(1e-30f));
  if ((C.soft_shadows & 8) != 0) store_shadow3(finite_or_zero(mad(change3, scale, near_first_shadow3(0, 0))));
  if ((C.soft_shadows & 16) != 0) store_shadow4(finite_or_zero(mad(change4, scale, near_first_shadow4(0, 0))));
  if ((C.soft_shadows & 32) != 0) store_shadow5(finite_or_zero(mad(change5, scale, near_first_shadow5(0, 0))));
  if ((C.soft_shadows & 64) != 0) store_shadow6(finite_or_zero(mad(change6, scale, near_first_shadow6(0, 0))));
  if ((C.soft_shadows & 128) != 0) store_shadow7(finite_or_zero(mad(change7, scale, near_first_shadow7(0, 0))));
}
