// Upsamples occlusion and indirect light from reduced to full resolution.
IN_COLOR(reduced_indirect)
OUT_COLOR(indirect)
#include "effects/upsample/upsample.kernel.h"

FN Vec3 small_light(int i, int j) { return clean_light(block_reduced_indirect(C.factor, i, j)); }

// Sums differences from the own block's value, so that equal values stay bitwise identical.
FN void upsample_light_pixel(Int px, Int py) {
  Vec3 fractions = shares_of(px, py);
  Real own = small_ao(0, 0);
  Real change = change_of_ao(fractions, own);
  Vec3 own_light = small_light(0, 0);
  Vec3 light_change = (small_light(1, 0) - own_light) * fractions.x + (small_light(0, 1) - own_light) * fractions.y +
                      (small_light(1, 1) - own_light) * fractions.z;
  Bool few = fractions.x < 0.0f;
  if (some(few)) {
    // Where the technique will compute the occlusion, light is taken from the four nearest blocks: sixteen would cost
    // more.
    int nearest = C.leave != 0 ? 0 : 1;
    Real sum = Real(0.0f);
    Real wide = Real(0.0f);
    Vec3 wide_light = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
    for (int j = -nearest; j <= 1 + nearest; ++j)
      for (int i = -nearest; i <= 1 + nearest; ++i) {
        Real weight = wide_weight(i, j, px, py);
        sum = sum + weight;
        wide = mad(weight, small_ao(i, j) - own, wide);
        wide_light = wide_light + (small_light(i, j) - own_light) * weight;
      }
    Real scale = Real(1.0f) / sum;
    change = select(few, wide * scale, change);
    light_change = select(few, wide_light * scale, light_change);
  }
  Real ao = own + change;
  if (C.leave != 0) ao = select(few, missing_ao(), ao);
  store_ao(ao);
  store_indirect(own_light + light_change);
}
