// Writes two parts of `lit`: `lit_direct`, the light of the lights, and `lit_indirect`, that of other surfaces, as the
// mode of composite.kernel.h combines them. The rest is ambient light.
IN_COLOR(direct)
IN_COLOR(ambient)
IN_COLOR(indirect)
IN_COLOR(albedo)
IN_REAL(ao)
OUT_COLOR(lit_direct)
OUT_COLOR(lit_indirect)

#include "effects/composite/composite_combine.kernel.h"

FN void composite_parts_pixel(Int px, Int py) {
  Combined all = combined();
  store_lit_direct(finite_or_zero(all.direct));
  store_lit_indirect(finite_or_zero(all.bounced));
}
