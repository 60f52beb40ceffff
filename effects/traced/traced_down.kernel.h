// Filters the visibility along columns, from `traced_across` to `ao`.
IN_REAL(traced_across)
IN_REAL(traced_across_confidence)
OUT_REAL(ao)
OUT_REAL(traced_confidence)

CONST bool kAlongRows = false;
FN Real open_at(int i, int j) { return near_traced_across(i, j); }
FN Real confidence_at(int i, int j) { return near_traced_across_confidence(i, j); }
#include "effects/traced/traced_no_light.kernel.h"

#include "effects/traced/traced.kernel.h"

FN void traced_down_pixel(Int px, Int py) {
  Filtered pixel = filtered(px, py);
  store_ao(pixel.open);
  store_traced_confidence(pixel.confidence);
}
