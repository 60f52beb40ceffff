// Filters visibility and indirect light along columns, from `traced_across` and `traced_light` to `ao` and `indirect`.
IN_REAL(traced_across)
IN_REAL(traced_across_confidence)
IN_COLOR(traced_light)
OUT_REAL(ao)
OUT_REAL(traced_confidence)
OUT_COLOR(indirect)

CONST bool kAlongRows = false;
CONST bool kLight = true;
FN Real open_at(int i, int j) { return near_traced_across(i, j); }
FN Real confidence_at(int i, int j) { return near_traced_across_confidence(i, j); }
FN Vec3 light_at(int i, int j) { return near_traced_light(i, j); }
#include "effects/traced/traced.kernel.h"

FN void traced_light_down_pixel(Int px, Int py) {
  Filtered pixel = filtered(px, py);
  store_ao(pixel.open);
  store_traced_confidence(pixel.confidence);
  store_indirect(pixel.light);
}
