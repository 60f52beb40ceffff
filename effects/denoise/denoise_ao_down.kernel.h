// Filters occlusion along columns, from `denoise_ao` to `ao`.
IN_REAL(denoise_ao)
OUT_REAL(ao)

CONST bool kAlongRows = false;
FN Real ao_at(int i, int j) { return clean_ao(near_denoise_ao(i, j)); }
#include "effects/denoise/denoise_no_light.kernel.h"

#include "effects/denoise/denoise_filter.kernel.h"

FN void denoise_ao_down_pixel(Int px, Int py) { store_ao(filtered(px, py).ao); }
