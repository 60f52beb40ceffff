// Filters visibility and indirect light along rows, from `ao` and `indirect` to `traced_across` and `traced_light`.
IN_REAL(ao)
IN_REAL(traced_confidence)
IN_COLOR(indirect)
OUT_REAL(traced_across)
OUT_REAL(traced_across_confidence)
OUT_COLOR(traced_light)

CONST bool kAlongRows = true;
CONST bool kLight = true;
FN Real open_at(int i, int j) { return near_ao(i, j); }
FN Real confidence_at(int i, int j) { return near_traced_confidence(i, j); }
FN Vec3 light_at(int i, int j) { return near_indirect(i, j); }
#include "effects/traced/traced.kernel.h"

FN void traced_light_across_pixel(Int px, Int py) {
  Filtered pixel = filtered(px, py);
  store_traced_across(pixel.open);
  store_traced_across_confidence(pixel.confidence);
  store_traced_light(pixel.light);
}
