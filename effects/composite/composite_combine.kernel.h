// Combines light and occlusion by the mode. Shared by composite.kernel.h and composite_parts.kernel.h, which declare
// the planes.
#include "kernel/occlusion_strength.kernel.h"

FN Vec3 gray(Real v) { return Vec3(v, v, v); }

FN Real luminance_of(Vec3 v) { return dot(v, Vec3(Real(0.2126f), Real(0.7152f), Real(0.0722f))); }  // Rec.709

// Returns the fraction of ambient light that arrives directly or by any number of bounces between surfaces of the same
// albedo: a fit to ray-traced pictures [Jimenez et al. 2016, equation 10].
FN Real with_interreflections(Real ao, Real albedo) {
  Real a = mad(albedo, Real(2.0404f), Real(-0.3324f));
  Real b = mad(albedo, Real(-4.7951f), Real(0.6417f));
  Real c = mad(albedo, Real(2.7552f), Real(0.6903f));
  return max(ao, min(mad(mad(ao, a, b), ao, c) * ao, Real(1.0f)));
}

// Returns, per channel, the fraction of ambient light that arrives: `ao`, raised towards with_interreflections() by
// C.tint.
FN Vec3 tinted(Real ao, Vec3 albedo) {
  Vec3 gray_ao = gray(ao);
  if (C.tint == 0.0f) return gray_ao;
  Real open = clamp(ao, Real(0.0f), Real(1.0f));
  Vec3 colour = Vec3(clamp(albedo.x, Real(0.0f), Real(1.0f)), clamp(albedo.y, Real(0.0f), Real(1.0f)),
                     clamp(albedo.z, Real(0.0f), Real(1.0f)));
  Vec3 added = Vec3(with_interreflections(open, colour.x), with_interreflections(open, colour.y),
                    with_interreflections(open, colour.z)) -
               gray(open);
  return gray_ao + added * Real(C.tint);
}

// The light of a pixel, and the two of its parts that come from the lights and from other surfaces.
struct Combined {
  Vec3 lit;
  Vec3 direct;
  Vec3 bounced;
};

FN Combined combined() {
  Real ao = near_ao(0, 0);
  if (C.occlusion != 1.0f) ao = stronger_ao(ao, C.occlusion);
  Combined all = Combined(gray(ao), gray(Real(0.0f)), gray(Real(0.0f)));
  if (C.mode != 4) {
    Vec3 direct = near_direct(0, 0);
    Vec3 ambient = near_ambient(0, 0);
    Vec3 albedo = near_albedo(0, 0);
    if (C.display != 0) albedo = display_from_linear(albedo);
    Vec3 bounced = albedo * near_indirect(0, 0);
    Vec3 lit = direct + ambient + bounced;
    if (C.mode == 5 && C.damping > 0.0f)
      bounced = bounced * clamp(luminance_of(direct) * Real(1.0f / C.damping), Real(0.0f), Real(1.0f));
    if (C.direct > 0.0f && (C.mode == 0 || C.mode == 5))
      direct = direct * mad(clamp(ao, Real(0.0f), Real(1.0f)) - 1.0f, Real(C.direct), Real(1.0f));
    if (C.mode == 0 || C.mode == 5) lit = direct + bounced + ambient * tinted(ao, near_albedo(0, 0));
    if (C.mode == 1) lit = lit + gray(ao - 1.0f);
    if (C.mode == 2) lit = (direct + ambient) * ao + bounced;
    if (C.mode == 3) {
      Real d = ao - 1.0f;
      Real luminance = luminance_of(lit);
      Real chroma_factor = max(mad(d, Real(C.chroma), Real(1.0f)), Real(0.0f));
      lit = gray(luminance) + (lit - gray(luminance)) * chroma_factor;
      // Contrast is relative to middle grey.
      lit = gray(Real(0.5f)) + (lit - gray(Real(0.5f))) * max(mad(d, Real(C.contrast), Real(1.0f)), Real(0.0f));
      lit = lit + gray(d * Real(C.darkness));
    }
    if (C.mode == 6) lit = albedo * ao;
    if (C.mode == 2) direct = direct * ao;
    all = Combined(lit, direct, bounced);
  }
  return all;
}
