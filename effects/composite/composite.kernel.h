// Joins light and occlusion. Modes:
//   ambient    direct + ambient ao: occlusion keeps out what comes from everywhere, and nothing else
//   subtract   direct + ambient - (1 - ao), with ao above 1 brightening [Chamberlin 2011, listing: color - shade]
//   multiply   (direct + ambient) ao
//   modulate   brightness, chroma and contrast of the light follow dD = ao - 1 [Luft 2006, from the literature]
//   occlusion  ao alone, as grey
IN_COLOR(direct)
IN_COLOR(ambient)
IN_REAL(ao)
OUT_COLOR(lit)

FN Vec3 gray(Real v) { return Vec3(v, v, v); }

FN void composite_pixel(Int px, Int py) {
  Real ao = near_ao(0, 0);
  Vec3 direct = near_direct(0, 0);
  Vec3 ambient = near_ambient(0, 0);
  Vec3 light = direct + ambient;
  if (C.mode == 0) light = direct + ambient * ao;
  if (C.mode == 1) light = light + gray(ao - 1.0f);
  if (C.mode == 2) light = light * ao;
  if (C.mode == 3) {
    Real d = ao - 1.0f;
    Real luminance = dot(light, Vec3(Real(0.2126f), Real(0.7152f), Real(0.0722f)));  // Rec.709
    Real less_chroma = max(mad(d, Real(C.chroma), Real(1.0f)), Real(0.0f));
    light = gray(luminance) + (light - gray(luminance)) * less_chroma;
    // Contrast about middle grey, and the mask itself added.
    light = gray(Real(0.5f)) + (light - gray(Real(0.5f))) * max(mad(d, Real(C.contrast), Real(1.0f)), Real(0.0f));
    light = light + gray(d * Real(C.darkness));
  }
  if (C.mode == 4) light = gray(ao);
  store_lit(finite_or_zero(light));
}
