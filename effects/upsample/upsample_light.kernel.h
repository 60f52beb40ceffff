// Upsamples occlusion and indirect light from reduced to full resolution.
IN_COLOR(reduced_indirect)
OUT_COLOR(indirect)
#include "effects/upsample/upsample.kernel.h"

// Returns the reduced indirect light of the block i blocks right and j blocks down.
FN Vec3 light_of_block(int i, int j) { return clean_light(block_reduced_indirect(C.factor, i, j)); }

// Sums differences to the own block's value, so that a constant stays bitwise identical.
FN void upsample_light_pixel(Int px, Int py) {
  Vec3 weights = corner_weights(px, py);
  Real own = ao_of_block(0, 0);
  Real change = change_of_ao(weights, own);
  Vec3 own_light = light_of_block(0, 0);
  Vec3 light_change = (light_of_block(1, 0) - own_light) * weights.x + (light_of_block(0, 1) - own_light) * weights.y +
                      (light_of_block(1, 1) - own_light) * weights.z;
  Bool too_few = weights.x < 0.0f;
  if (some(too_few)) {
    // If the technique will compute the occlusion, light is taken from the four nearest blocks, which is faster than
    // sixteen.
    int nearest = C.leave != 0 ? 0 : 1;
    Real sum = Real(0.0f);
    Real wide = Real(0.0f);
    Vec3 wide_light = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
    for (int j = -nearest; j <= 1 + nearest; ++j)
      for (int i = -nearest; i <= 1 + nearest; ++i) {
        Real weight = wide_weight(i, j, px, py);
        sum = sum + weight;
        wide = mad(weight, ao_of_block(i, j) - own, wide);
        wide_light = wide_light + (light_of_block(i, j) - own_light) * weight;
      }
    Real scale = Real(1.0f) / sum;
    change = select(too_few, wide * scale, change);
    light_change = select(too_few, wide_light * scale, light_change);
  }
  Real ao = own + change;
  if (C.leave != 0) ao = select(too_few, missing_ao(), ao);
  store_ao(ao);
  store_indirect(own_light + light_change);
}
