// Writes the parts of `beauty`, exposed like it: `beauty_direct`, `beauty_ambient` and `beauty_indirect`, whose sum is
// the light of the surface, and `beauty_background`, the rest: light from behind, and the change by lines.
IN_COLOR(lit)
IN_COLOR(lit_direct)
IN_COLOR(lit_indirect)
IN_REAL(depth)
IN_REAL(cover)
IN_REAL(shadow_catcher)
IN_COLOR(beauty)
OUT_COLOR(beauty_direct)
OUT_COLOR(beauty_ambient)
OUT_COLOR(beauty_indirect)
OUT_COLOR(beauty_background)

#include "effects/output/output_light.kernel.h"

FN void output_parts_pixel(Int px, Int py) {
  Bool surface = is_finite(near_depth(0, 0));
  Vec3 none = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  Vec3 light = light_of(near_lit(0, 0) * Real(C.gain));
  Vec3 direct = finite_or_zero(near_lit_direct(0, 0) * Real(C.gain));
  Vec3 indirect = finite_or_zero(near_lit_indirect(0, 0) * Real(C.gain));
  store_beauty_direct(select(surface, direct, none));
  store_beauty_indirect(select(surface, indirect, none));
  store_beauty_ambient(select(surface, light - direct - indirect, none));
  // Where something covers a fraction of the pixel, `lit` is multiplied by that fraction.
  Bool covered = surface || near_cover(0, 0) > 0.0f || near_shadow_catcher(0, 0) > 0.0f;
  store_beauty_background(near_beauty(0, 0) - select(covered, light, none));
}
