// First dispatch of `toon`: computes the intensity of a surface's light, one number, before quantization into tone
// steps. Based on [Lajzer and Nottingham], listing 2: i = (max(0, N.L) + 0.1) ao + 0.2.
//
// Differs in ramp mode: every light adds to the diffuse part, relative to the key light. The key light's shadow is
// applied. The highlight is stored in a plane of its own, which is positive inside the highlight and negative outside.
// Differs in both modes: a material without specular reflection has no highlight, whatever its exponent.
IN_REAL(depth)
IN_VECTOR(normal)
IN_REAL(specular)
IN_REAL(shininess)
IN_REAL(shadow)
IN_REAL(ao)
OUT_REAL(toon_intensity)
OUT_REAL(toon_highlight)

#include "kernel/occlusion_strength.kernel.h"
#include "kernel/surface.kernel.h"

// Min value of toon_highlight. If the value decay from 1 to less than this within a pixel, the highlight there is
// narrower than 1/16 of a pixel.
CONST float kNoHighlight = -16.0f;
CONST float kInverseLn2 = 1.44269504f;
// Shadows are captured with one ray per pixel. Their edges are smoothed over neighbours on the same surface, but not
// across a silhouette or an edge of a solid.
CONST float kTolerancePx = 1.0f;      // max distance of a neighbour from the pixel's plane, pixel sizes
CONST float kMinNormalCosine = 0.9f;  // min cosine between the normals of the pixel and a neighbour: 25 degrees

// Returns the visibility of the key light, with edges smoothed over the pixel's neighbours on the same surface.
FN Real smooth_shadow(Int px, Int py, Vec3 position, Vec3 normal) {
  Real centre = near_shadow(0, 0);
  Bool differs = abs(centre) > 1.0f;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) differs = differs || abs(near_shadow(i, j) - centre) > 0.0f;
  if (!some(differs)) return centre;
  Real sum = Real(0.0f);
  Real weights = Real(0.0f);
  for (int j = -1; j <= 1; ++j) {
    for (int i = -1; i <= 1; ++i) {
      Vec3 there = view_position(px + Int(i), py + Int(j), near_depth(i, j));
      Vec3 other = near_normal(i, j);
      Bool same = surface_distance(position, normal, there, other, kTolerancePx) <= 1.0f;
      same = same && dot(other, normal) > kMinNormalCosine;
      Real weight = Real(float((2 - i * i) * (2 - j * j)));
      weight = select(same, weight, Real(0.0f));
      sum = mad(weight, select(same, near_shadow(i, j), Real(0.0f)), sum);
      weights = weights + weight;
    }
  }
  return select(weights > 0.0f, sum / max(weights, Real(1.0f)), centre);
}

FN void toon_light_pixel(Int px, Int py) {
  Real depth = near_depth(0, 0);
  Bool surface = is_finite(depth);
  if (!some(surface)) {
    store_toon_intensity(Real(0.0f));
    store_toon_highlight(Real(kNoHighlight));
    return;
  }
  Vec3 position = view_position(px, py, select(surface, depth, Real(1.0f)));
  Vec3 normal = normalized(near_normal(0, 0));
  Real exponent = near_shininess(0, 0);
  Real key_visibility = Real(1.0f);
  if (C.shadow > 0.0f) {
    key_visibility = C.mode == kToonPaper ? near_shadow(0, 0) : smooth_shadow(px, py, position, normal);
    key_visibility = mad(clamp(key_visibility, Real(0.0f), Real(1.0f)) - 1.0f, Real(C.shadow), Real(1.0f));
  }
  Real diffuse = Real(0.0f);
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
    if (k == 0) attenuation = attenuation * key_visibility;
    Real facing = dot(normal, light);
    diffuse = mad(attenuation, max(facing, Real(0.0f)), diffuse);
    if (k == 0 && C.specular > 0.0f) {
      if (C.mode == kToonPaper) {
        Vec3 halfway = normalized(light + Vec3(Real(0.0f), Real(0.0f), Real(1.0f)));
        gloss = pow(max(dot(normal, halfway), Real(0.0f)), exponent) * key_visibility * Real(C.specular);
        gloss = select(exponent > 1.0f && near_specular(0, 0) > 0.0f, gloss, Real(0.0f));
      } else {
        // The highlight is where max(0, N.H)^e exceeds one half, approximated by exp(-e (1 - N.H)). Its value is 1 in
        // the middle and 0 at the edge. It is also negative in shadow and on a surface that faces away from the light.
        Vec3 halfway = normalized(light + to_eye(position));
        Real decay = max(exponent, Real(1.0f)) * Real(C.sharpness * kInverseLn2);
        highlight = mad(dot(normal, halfway) - 1.0f, decay, Real(1.0f));
        highlight = min(min(highlight, facing), mad(key_visibility, Real(2.0f), Real(-1.0f)));
      }
    }
  }
  Real ao = near_ao(0, 0);
  if (C.occlusion != 1.0f) ao = stronger_ao(ao, C.occlusion);
  Real intensity = mad(diffuse + C.ambient, ao, Real(C.extra)) + gloss;
  store_toon_intensity(select(surface, finite_or_zero(intensity), Real(0.0f)));
  highlight = select(surface && is_finite(highlight), max(highlight, Real(kNoHighlight)), Real(kNoHighlight));
  store_toon_highlight(highlight);
}
