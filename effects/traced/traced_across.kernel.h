// Filters the visibility along rows, from `ao` to `traced_across`.
IN_REAL(ao)
IN_REAL(traced_confidence)
OUT_REAL(traced_across)
OUT_REAL(traced_across_confidence)

CONST bool kAlongRows = true;
FN Real open_at(int i, int j) { return near_ao(i, j); }
FN Real confidence_at(int i, int j) { return near_traced_confidence(i, j); }
#include "effects/traced/traced_no_light.kernel.h"

#include "effects/traced/traced.kernel.h"

FN void traced_across_pixel(Int px, Int py) {
  Filtered pixel = filtered(px, py);
  store_traced_across(pixel.open);
  store_traced_across_confidence(pixel.confidence);
}
