// First dispatch of `hatching`: how much ink each pixel needs so that the picture shows its light, and the light of the
// paper in its place; `output` draws the lines over that.
IN_REAL(depth)
IN_COLOR(albedo)
IN_COLOR(emission)
INOUT_COLOR(lit)
OUT_REAL(hatching_ink)

CONST float kClay = 0.90633f;  // display value of clay, an albedo of 0.8

FN Real luminance_of(Vec3 v) { return mad(v.x, Real(0.2126f), mad(v.y, Real(0.7152f), v.z * 0.0722f)); }

// Returns the fraction of the area that lines cover where there is this light.
FN Real ink_of(Vec3 light) {
  Real shown = display_from_linear(clamp(luminance_of(light) * C.gain, Real(0.0f), Real(1.0f)));
  if (C.material > 0.0f) {
    Real own = display_from_linear(clamp(luminance_of(clean_light(near_albedo(0, 0))), Real(0.0f), Real(1.0f)));
    shown = shown * mad(min(own * (1.0f / kClay), Real(1.0f)) - 1.0f, Real(C.material), Real(1.0f));
  }
  shown =
      max(shown, display_from_linear(clamp(luminance_of(clean_light(near_emission(0, 0))), Real(0.0f), Real(1.0f))));
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
