// First dispatch of `toon`: computes the intensity of a surface's light before quantization into tone steps,
// toon_key toon_visible + toon_rest. Based on [Lajzer and Nottingham], listing 2: i = (max(0, N.L) + 0.1) ao + 0.2.
//
// Differs in ramp mode: every light adds to the diffuse part, relative to the key light. The light of the key light and
// its visibility have planes of their own, since the following dispatches smooth light but keep the edges of shadows.
// The highlight has one, too, which is positive inside the highlight and negative outside.
// Differs in both modes: a material without specular reflection has no highlight, whatever its exponent.
IN_REAL(depth)
IN_VECTOR(normal)
IN_REAL(specular)
IN_REAL(shininess)
IN_REAL(shadow)
IN_REAL(ao)
OUT_REAL(toon_key)
OUT_REAL(toon_rest)
OUT_REAL(toon_visible)
OUT_REAL(toon_highlight)

#include "kernel/occlusion_strength.kernel.h"

// Min value of toon_highlight. If the value decay from 1 to less than this within a pixel, the highlight there is
// narrower than 1/16 of a pixel.
CONST float kNoHighlight = -16.0f;
CONST float kInverseLn2 = 1.44269504f;

FN void toon_light_pixel(Int px, Int py) {
  Real depth = near_depth(0, 0);
  Bool surface = is_finite(depth);
  if (!some(surface)) {
    store_toon_key(Real(0.0f));
    store_toon_rest(Real(0.0f));
    store_toon_visible(Real(1.0f));
    store_toon_highlight(Real(kNoHighlight));
    return;
  }
  Vec3 position = view_position(px, py, select(surface, depth, Real(1.0f)));
  Vec3 normal = normalized(near_normal(0, 0));
  Real exponent = near_shininess(0, 0);
  Real visible = Real(1.0f);
  if (C.shadow > 0.0f) visible = clamp(finite_or_zero(near_shadow(0, 0)), Real(0.0f), Real(1.0f));
  Real key = Real(0.0f);
  Real diffuse = Real(C.ambient);
  Real gloss = Real(0.0f);
  Real highlight = Real(kNoHighlight);
  for (int k = 0; k < C.light_count; ++k) {
    Vec3 light = Vec3(Real(C.x[k]), Real(C.y[k]), Real(C.z[k]));
    Real attenuation = Real(C.fraction[k]);
    if (C.kind[k] == 1) {
      Vec3 to_light = light - position;
      Real squared = max(dot(to_light, to_light), Real(1e-20f));
      light = to_light * rsqrt(squared);
      if (C.reach_squared[k] > 0.0f) attenuation = attenuation * (Real(C.reach_squared[k]) / squared);
    }
    Real facing = dot(normal, light);
    Real added = attenuation * max(facing, Real(0.0f));
    if (k > 0) diffuse = diffuse + added;
    if (k == 0) key = added;
    if (k == 0 && C.specular > 0.0f) {
      if (C.mode == kToonPaper) {
        Vec3 halfway = normalized(light + Vec3(Real(0.0f), Real(0.0f), Real(1.0f)));
        gloss = pow(max(dot(normal, halfway), Real(0.0f)), exponent) * Real(C.specular);
        gloss = select(exponent > 1.0f && near_specular(0, 0) > 0.0f, gloss, Real(0.0f));
      } else {
        // The highlight is where max(0, N.H)^e exceeds one half, approximated by exp(-e (1 - N.H)). Its value is 1 in
        // the middle and 0 at the edge. It is also negative on a surface that faces away from the light.
        Vec3 halfway = normalized(light + to_eye(position));
        Real decay = max(exponent, Real(1.0f)) * Real(C.sharpness * kInverseLn2);
        highlight = min(mad(dot(normal, halfway) - 1.0f, decay, Real(1.0f)), facing);
      }
    }
  }
  Real ao = near_ao(0, 0);
  if (C.occlusion != 1.0f) ao = stronger_ao(ao, C.occlusion);
  Real none = Real(0.0f);
  store_toon_key(select(surface, finite_or_zero(mad(key, ao, gloss)), none));
  store_toon_rest(select(surface, finite_or_zero(mad(diffuse, ao, Real(C.extra))), none));
  store_toon_visible(select(surface, visible, Real(1.0f)));
  highlight = select(surface && is_finite(highlight), max(highlight, Real(kNoHighlight)), Real(kNoHighlight));
  store_toon_highlight(highlight);
}
