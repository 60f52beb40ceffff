// Light to what a file or a screen holds: exposure, transfer function, background. Based on [IEC 61966-2-1] for sRGB.
//
// Where there is no surface `lit` is what a line sends that covers the share `outline` of the pixel, or what shade
// sends, or surfaces in the mean of several pictures do, that cover the share `cover`; or `outline`, where those are
// averaged for the eye.
IN_COLOR(lit)
IN_REAL(depth)
IN_REAL(outline)
IN_REAL(cover)
IN_COLOR(sky)
OUT_COLOR(color)
OUT_ALPHA(color)

FN Real srgb_from_linear(Real v) {
  Real curve = mad(pow(v, Real(0.416666667f)), Real(1.055f), Real(-0.055f));
  return select(v > 0.0031308f, curve, v * 12.92f);
}

// Light beyond the shoulder, bent so that it nears 1 and never exceeds it.
FN Real compressed(Real v) {
  Real over = max(v - C.shoulder, Real(0.0f)) * Real(C.room);
  return min(v, Real(C.shoulder)) + (Real(1.0f) - Real(1.0f) / (over + 1.0f)) * Real(1.0f - C.shoulder);
}

// Light, not below 0, as it is exposed.
FN Vec3 exposed(Vec3 light) {
  light = finite_or_zero(light);  // what is not a number is black
  light = Vec3(max(light.x, Real(0.0f)), max(light.y, Real(0.0f)), max(light.z, Real(0.0f)));
  if (C.room > 0.0f) light = Vec3(compressed(light.x), compressed(light.y), compressed(light.z));
  return light;
}

FN void output_pixel(Int px, Int py) {
  Bool surface = is_finite(near_depth(0, 0));
  Real line = clamp(near_outline(0, 0), Real(0.0f), Real(1.0f));
  Real shade = clamp(near_cover(0, 0), Real(0.0f), Real(1.0f));
  Bool lines = line > shade;
  Real covered = max(line, shade);
  Real share = select(surface || covered == Real(0.0f), Real(1.0f), covered);
  Vec3 light = exposed(near_lit(0, 0) * (Real(C.gain) / share));
  // What covers a share over the background, with straight alpha.
  Real behind = (Real(1.0f) - covered) * Real(C.background_alpha);
  Real alpha = covered + behind;
  Real scale = Real(1.0f) / select(alpha > 0.0f, alpha, Real(1.0f));
  Vec3 beyond = Vec3(Real(C.behind_r), Real(C.behind_g), Real(C.behind_b));
  if (C.sky != 0) beyond = exposed(near_sky(0, 0) * Real(C.gain));
  Vec3 both = light * (covered * scale) + beyond * (behind * scale);
  both = select(lines, mixed_for_the_eye(beyond, light, covered * scale), both);
  light = select(surface, light, both);
  if (C.transfer == 0) light = Vec3(srgb_from_linear(light.x), srgb_from_linear(light.y), srgb_from_linear(light.z));
  Vec3 background = Vec3(Real(C.background_r), Real(C.background_g), Real(C.background_b));
  if (C.sky != 0 && C.background_alpha > 0.0f) background = light;
  store_color(select(surface || covered > 0.0f, light, background));
  store_color_alpha(select(surface, Real(1.0f), alpha));
}
