// First dispatch of `hatching`: how much ink each pixel needs so that the picture shows its light, and the light of the
// paper in its place; `output` draws the lines over that.
IN_REAL(depth)
INOUT_COLOR(lit)
OUT_REAL(hatching_ink)

// Returns the fraction of the area that lines cover where there is this light.
FN Real ink_of(Vec3 light) {
  Real luminance = mad(light.x, Real(0.2126f), mad(light.y, Real(0.7152f), light.z * 0.0722f)) * C.gain;
  Real shown = display_from_linear(clamp(luminance, Real(0.0f), Real(1.0f)));
  if (C.contrast != 1.0f) shown = pow(shown, Real(C.contrast));
  return C.strokes == kHatchingShade ? Real(1.0f) - shown : shown;
}

FN void hatching_tone_pixel(Int px, Int py) {
  Bool surface = is_surface(near_depth(0, 0));
  Real ink = clamp(ink_of(clean_light(own_lit())), Real(0.0f), Real(1.0f));
  store_hatching_ink(select(surface, ink, Real(0.0f)));
  Vec3 paper = Vec3(Real(C.paper_r), Real(C.paper_g), Real(C.paper_b));
  store_lit(select(surface, paper, Vec3(Real(0.0f), Real(0.0f), Real(0.0f))));
}
