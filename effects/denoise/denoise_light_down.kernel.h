// Filters occlusion and indirect light along columns, from `denoise_ao` and `denoise_indirect` to `ao` and `indirect`.
IN_REAL(denoise_ao)
IN_COLOR(denoise_indirect)
OUT_REAL(ao)
OUT_COLOR(indirect)

CONST bool kLight = true;
CONST bool kAlongRows = false;
FN Real ao_at(int i, int j) { return clean_ao(near_denoise_ao(i, j)); }
FN Vec3 light_at(int i, int j) { return clean_light(near_denoise_indirect(i, j)); }
#include "effects/denoise/denoise_filter.kernel.h"

FN void denoise_light_down_pixel(Int px, Int py) {
  Filtered pixel = filtered(px, py);
  store_ao(pixel.ao);
  store_indirect(pixel.light);
}
