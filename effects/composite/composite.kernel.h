// Combines light and occlusion. bounced = albedo indirect is the light from other surfaces that the point reflects. The
// effect that computed it has accounted for occluders, so that `ao` does not darken it again. Modes:
//   ambient    direct + bounced + ambient ao: occlusion affects ambient light only
//   subtract   direct + bounced + ambient - (1 - ao); ao above 1 brightens [Chamberlin 2011, listing: color - shade]
//   multiply   (direct + ambient) ao + bounced
//   modulate   d = ao - 1 changes brightness, chroma and contrast of direct + bounced + ambient [Luft 2006, from the
//              literature]
//   occlusion  ao alone, as a grey value
//   albedo     albedo ao: occlusion on the colours of surfaces
//   bleeding   direct + bounced min(luminance of direct / damping, 1) + ambient ao [Colliander and Törnquist 2015,
//              "Blur Pass"]
IN_COLOR(direct)
IN_COLOR(ambient)
IN_COLOR(indirect)
IN_COLOR(albedo)
IN_REAL(ao)
OUT_COLOR(lit)
#include "effects/composite/composite_combine.kernel.h"

FN void composite_pixel(Int px, Int py) { store_lit(finite_or_zero(combined().lit)); }
