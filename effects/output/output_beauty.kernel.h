// Writes `beauty`, the picture as scene-linear light: exposed, before the tone curve, the shoulder and the transfer
// function, and premultiplied by alpha, as in [OpenEXR]. Otherwise it mixes the same as output.kernel.h.
IN_COLOR(lit)
IN_REAL(depth)
IN_REAL(outline)
IN_COLOR(line)
IN_REAL(cover)
IN_REAL(cover_for_eye)
IN_REAL(shadow_catcher)
IN_COLOR(sky)
OUT_COLOR(beauty)
OUT_ALPHA(beauty)

#include "effects/output/output_mix.kernel.h"

// Returns exposed light: finite and not negative.
FN Vec3 light_of(Vec3 light) { return clamped_to_0(finite_or_zero(light)); }

// Returns the linear value of an sRGB encoding.
FN Real linear_from_display(Real v) {
  Real curve = pow(mad(max(v, Real(0.0f)), Real(1.0f / 1.055f), Real(0.055f / 1.055f)), Real(2.4f));
  return select(v > 0.04045f, curve, v * (1.0f / 12.92f));
}

FN void output_beauty_pixel(Int px, Int py) {
  Bool surface = is_finite(near_depth(0, 0));
  Real of_eye = fraction_of(near_cover_for_eye(0, 0));
  Real shade = fraction_of(near_shadow_catcher(0, 0));
  if (C.cover_display != 0) shade = fraction_of(Real(1.0f) - linear_from_display(Real(1.0f) - shade));
  Real of_light = max(fraction_of(near_cover(0, 0)), shade);
  Real covered = max(of_eye, of_light);
  Real fraction = select(surface || covered == Real(0.0f), Real(1.0f), covered);
  Vec3 light = light_of(near_lit(0, 0) * (Real(C.gain) / fraction));
  Vec3 beyond = background_at(py, Vec3(Real(C.beauty_behind_r), Real(C.beauty_behind_g), Real(C.beauty_behind_b)));
  if (C.sky != 0) beyond = light_of(near_sky(0, 0) * Real(C.gain));
  Mixed mixed = mixed_with_background_and_lines(surface, light, covered, of_eye > of_light, beyond);
  light = mixed.light;
  if (C.decode != 0)
    light = Vec3(linear_from_display(light.x), linear_from_display(light.y), linear_from_display(light.z));
  store_beauty(light * mixed.alpha);
  store_beauty_alpha(mixed.alpha);
}
