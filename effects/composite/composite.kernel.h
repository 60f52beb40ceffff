// Joins light and occlusion. What bounced = albedo indirect adds is light that surfaces in sight sent: whoever made it
// knows what stands in its way, and occlusion does not darken it again. Modes:
//   ambient    direct + bounced + ambient ao: occlusion keeps out what comes from everywhere, and nothing else
//   subtract   direct + bounced + ambient - (1 - ao), with ao above 1 brightening [Chamberlin 2011, listing: color -
//              shade]
//   multiply   (direct + ambient) ao + bounced
//   modulate   brightness, chroma and contrast of direct + bounced + ambient follow dD = ao - 1 [Luft 2006, from the
//              literature]
//   occlusion  ao alone, as grey
//   bleeding   direct + bounced damping + ambient ao, bounced light fading out where the direct light is less than
//              `damping` [Colliander and Törnquist 2015, "Blur Pass"]
IN_COLOR(direct)
IN_COLOR(ambient)
IN_COLOR(indirect)
IN_COLOR(albedo)
IN_REAL(ao)
OUT_COLOR(lit)

FN Vec3 gray(Real v) { return Vec3(v, v, v); }

FN Real luminance_of(Vec3 v) { return dot(v, Vec3(Real(0.2126f), Real(0.7152f), Real(0.0722f))); }  // Rec.709

FN void composite_pixel(Int px, Int py) {
  Real ao = near_ao(0, 0);
  Vec3 lit = gray(ao);
  if (C.mode != 4) {
    Vec3 direct = near_direct(0, 0);
    Vec3 ambient = near_ambient(0, 0);
    Vec3 albedo = near_albedo(0, 0);
    if (C.display != 0) albedo = display_from_linear(albedo);
    Vec3 bounced = albedo * near_indirect(0, 0);
    lit = direct + ambient + bounced;
    if (C.mode == 5 && C.damping > 0.0f)
      bounced = bounced * clamp(luminance_of(direct) * Real(1.0f / C.damping), Real(0.0f), Real(1.0f));
    if (C.mode == 0 || C.mode == 5) lit = direct + bounced + ambient * ao;
    if (C.mode == 1) lit = lit + gray(ao - 1.0f);
    if (C.mode == 2) lit = (direct + ambient) * ao + bounced;
    if (C.mode == 3) {
      Real d = ao - 1.0f;
      Real luminance = luminance_of(lit);
      Real less_chroma = max(mad(d, Real(C.chroma), Real(1.0f)), Real(0.0f));
      lit = gray(luminance) + (lit - gray(luminance)) * less_chroma;
      // Contrast about middle grey, and the mask itself added.
      lit = gray(Real(0.5f)) + (lit - gray(Real(0.5f))) * max(mad(d, Real(C.contrast), Real(1.0f)), Real(0.0f));
      lit = lit + gray(d * Real(C.darkness));
    }
  }
  store_lit(finite_or_zero(lit));
}
