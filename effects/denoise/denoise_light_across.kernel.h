// Filters occlusion and indirect light along rows, from `ao` and `indirect` to `denoise_ao` and `denoise_indirect`.
IN_REAL(ao)
IN_COLOR(indirect)
OUT_REAL(denoise_ao)
OUT_COLOR(denoise_indirect)

CONST bool kLight = true;
CONST bool kAlongRows = true;
FN Real ao_at(int i, int j) { return clean_ao(near_ao(i, j)); }
FN Vec3 light_at(int i, int j) { return clean_light(near_indirect(i, j)); }
#include "effects/denoise/denoise_filter.kernel.h"

FN void denoise_light_across_pixel(Int px, Int py) {
  Filtered pixel = filtered(px, py);
  store_denoise_ao(pixel.ao);
  store_denoise_indirect(pixel.light);
}
