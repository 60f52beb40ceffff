// Filters occlusion along rows, from `ao` to `denoise_ao`.
IN_REAL(ao)
OUT_REAL(denoise_ao)

CONST bool kAlongRows = true;
FN Real ao_at(int i, int j) { return clean_ao(near_ao(i, j)); }
#include "effects/denoise/denoise_no_light.kernel.h"

#include "effects/denoise/denoise_filter.kernel.h"

FN void denoise_ao_across_pixel(Int px, Int py) { store_denoise_ao(filtered(px, py).ao); }
