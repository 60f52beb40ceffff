// Occlusion and reflected light along rows, from `ao` and `indirect` to `denoise_ao` and `denoise_indirect`.
IN_REAL(ao)
IN_COLOR(indirect)
OUT_REAL(denoise_ao)
OUT_COLOR(denoise_indirect)

CONST bool kAlongRows = true;
FN Real ao_at(int i, int j) { return clean_ao(near_ao(i, j)); }
FN Vec3 light_at(int i, int j) { return clean_light(near_indirect(i, j)); }
FN void store_filtered(Real ao, Vec3 light) {
  store_denoise_ao(ao);
  store_denoise_indirect(light);
}
#include "effects/denoise/denoise_light.kernel.h"

FN void denoise_light_across_pixel(Int px, Int py) { filter_light(px, py); }
