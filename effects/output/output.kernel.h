// Converts light to the values of a file or a screen: exposure, tone curve, transfer function, background. Based on
// [IEC 61966-2-1] for sRGB and on [Khronos 2024] for the tone curve.
OUT_COLOR(color)
OUT_ALPHA(color)

#include "effects/output/output_mix.kernel.h"

FN Real srgb_from_linear(Real v) {
  Real curve = mad(pow(v, Real(0.416666667f)), Real(1.055f), Real(-0.055f));
  return select(v > 0.0031308f, curve, v * 12.92f);
}

// Returns light with the part beyond the shoulder compressed: it approaches 1 and never exceeds it.
FN Real compressed(Real v) {
  Real over = max(v - C.shoulder, Real(0.0f)) * Real(C.room);
  return min(v, Real(C.shoulder)) + (Real(1.0f) - Real(1.0f) / (over + 1.0f)) * Real(1.0f - C.shoulder);
}

// The constants of [Khronos 2024] are F90, Ks and Kd.
CONST float kRemoved = 0.04f;  // the light that a dielectric facing the camera reflects, as white as its light source
CONST float kToe = 0.5f;       // fraction of the light near black that is removed
CONST float kUncompressed = 0.76f;  // 0.8 - F90: brightest channel up to which light is not compressed
CONST float kDesaturation = 0.15f;  // how fast compressed light becomes white

// Returns light, which is not negative, after a tone curve like Khronos PBR Neutral [Khronos 2024]: its highlights are
// compressed below 1 and its shadows deepened; hue and saturation of what is between stay. Near black the curve of
// Khronos is a parabola with slope 0, in which shade indoors is lost: this one has slope 1/2 there.
FN Vec3 neutral(Vec3 light) {
  Real darkest = min(min(light.x, light.y), light.z);
  Real toe = darkest * mad(darkest, Real(-kToe * kToe / (4.0f * kRemoved)), Real(kToe));
  Real removed = select(darkest > 2.0f * kRemoved / kToe, Real(kRemoved), toe);
  light = light - Vec3(removed, removed, removed);
  Real peak = max(max(light.x, light.y), light.z);
  Real bright = max(peak, Real(kUncompressed));
  Real lowered =
      Real(1.0f) - Real((1.0f - kUncompressed) * (1.0f - kUncompressed)) / (bright + (1.0f - 2.0f * kUncompressed));
  Real colored = Real(1.0f) / mad(bright - lowered, Real(kDesaturation), Real(1.0f));
  Real white = lowered * (Real(1.0f) - colored);
  Vec3 compressed = light * (lowered * colored / bright) + Vec3(white, white, white);
  return select(peak > kUncompressed, compressed, light);
}

FN Real contrasted(Real v) { return pow(v * Real(1.0f / C.pivot), Real(C.contrast)) * Real(C.pivot); }

// Returns exposed light: finite, not negative, after contrast, compressed by the tone curve and the shoulder.
FN Vec3 exposed(Vec3 light) {
  light = light_of(light);
  if (C.tone == kToneHue) {
    // All channels are multiplied by one factor.
    Real peak = max(max(light.x, light.y), light.z);
    Real shown = peak;
    if (C.contrast != 1.0f) shown = contrasted(shown);
    return light * (min(shown, Real(1.0f)) / max(peak, Real(1e-20f)));
  }
  if (C.contrast != 1.0f) light = Vec3(contrasted(light.x), contrasted(light.y), contrasted(light.z));
  if (C.tone == kToneNeutral) light = neutral(light);
  if (C.room > 0.0f) light = Vec3(compressed(light.x), compressed(light.y), compressed(light.z));
  return light;
}

// Returns a threshold of the ordered dither of 8 x 8 pixels [Bayer 1973]: above -1/2 and below 1/2, 0 on average.
FN Real threshold(Int px, Int py) {
  Uint x = to_uint(px);
  Uint y = to_uint(py);
  Uint a = x ^ y;
  Uint order = ((a & Uint(1u)) << 5) | ((y & Uint(1u)) << 4) | ((a & Uint(2u)) << 2) | ((y & Uint(2u)) << 1) |
               ((a & Uint(4u)) >> 1) | ((y & Uint(4u)) >> 2);
  return mad(to_real(to_signed(order)), Real(1.0f / 64.0f), Real(-63.0f / 128.0f));
}

FN void output_pixel(Int px, Int py) {
  Front front = front_of(fraction_of(near_shadow_catcher(0, 0)));
  Vec3 beyond = background_at(py, Vec3(Real(C.behind_r), Real(C.behind_g), Real(C.behind_b)));
  if (C.sky != 0) beyond = exposed(near_sky(0, 0) * Real(C.gain));
  Mixed mixed = mixed_with_background_and_lines(front, exposed(front.light), beyond);
  Vec3 light = mixed.light;
  if (C.transfer == 0) light = Vec3(srgb_from_linear(light.x), srgb_from_linear(light.y), srgb_from_linear(light.z));
  Vec3 background = Vec3(Real(C.background_r), Real(C.background_g), Real(C.background_b));
  if ((C.sky != 0 || C.gradient > 0.0f) && C.background_alpha > 0.0f) background = light;
  Bool drawn = front.surface || front.covered > 0.0f || near_outline(0, 0) > 0.0f;
  Vec3 color = select(drawn, light, background);
  if (C.dither > 0.0f) {
    Real shown = select(front.surface, Real(0.0f), max(Real(1.0f) - front.covered, Real(0.0f)));
    Real off = threshold(px, py - Int(C.first_row)) * (shown * C.dither);
    color = color + Vec3(off, off, off);
  }
  store_color(color);
  store_color_alpha(mixed.alpha);
}
