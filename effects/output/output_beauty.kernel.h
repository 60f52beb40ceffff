// Writes `beauty`, the picture as scene-linear light: exposed, before the tone curve, the shoulder and the transfer
// function, and premultiplied by alpha, as in [OpenEXR]. Otherwise it mixes the same as output.kernel.h.
OUT_COLOR(beauty)
OUT_ALPHA(beauty)

#include "effects/output/output_mix.kernel.h"
#include "kernel/display.kernel.h"

FN void output_beauty_pixel(Int px, Int py) {
  Real shade = fraction_of(near_shadow_catcher(0, 0));
  if (C.cover_display != 0) shade = fraction_of(Real(1.0f) - linear_from_display(Real(1.0f) - shade));
  Front front = front_of(shade);
  Vec3 beyond = background_at(py, Vec3(Real(C.beauty_behind_r), Real(C.beauty_behind_g), Real(C.beauty_behind_b)));
  if (C.sky != 0) beyond = light_of(near_sky(0, 0) * Real(C.gain));
  Mixed mixed = mixed_with_background_and_lines(front, light_of(front.light), beyond);
  Vec3 light = mixed.light;
  if (C.decode != 0) light = linear_from_display(light);
  store_beauty(light * mixed.alpha);
  store_beauty_alpha(mixed.alpha);
}
