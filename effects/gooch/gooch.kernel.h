// Cool-to-warm shading [Gooch et al. 1998]: with t = (1 + n.l)/2, l the direction to the light,
//   colour = (1 - t) cool + t warm,   cool = (0, 0, b) + alpha kd,   warm = (y, y, 0) + beta kd.
// n.l is not clamped, so a surface that faces away from the light has tones too. All colours are display values, as in
// the paper; kd is the albedo as a display shows it.
//
// Differs: the paper prints the formula with the two tones exchanged, since its l points from the light to the surface.
// Saturated surfaces keep their hue: their tones are brighter and darker ones of their own colour, and turn by at most
// 12 degrees towards blue and yellow. The highlight is that of [Blinn 1977], and mixes towards white. Occlusion moves a
// surface towards the cool tone.
IN_REAL(depth)
IN_VECTOR(normal)
IN_COLOR(albedo)
IN_REAL(ao)
OUT_COLOR(lit)
#include "kernel/display.kernel.h"

#include "kernel/occlusion_strength.kernel.h"

CONST float kSaturated = 0.2f;    // saturation from which a surface has only tones of its own hue
CONST float kNearlyBlack = 0.1f;  // colours of this display value have half of their saturation
CONST float kTurn = 0.2f;         // of a hue, in sixths of the circle
CONST float kBlueTone = 0.25f;    // brightness of a saturated surface's cool tone, relative to `blue`

// Returns the surface's colour as display values, 0 to 1.
FN Vec3 display_albedo() {
  Vec3 v = finite_or_zero(near_albedo(0, 0));
  Real zero = Real(0.0f);
  Real one = Real(1.0f);
  return display_from_linear(Vec3(clamp(v.x, zero, one), clamp(v.y, zero, one), clamp(v.z, zero, one)));
}

// Returns the colour of a surface where the light is t, 0 to 1.
FN Vec3 tone_of(Vec3 albedo, Real t) {
  Real shade = Real(1.0f) - t;
  Real fraction = shade * C.alpha + t * C.beta;
  Vec3 sum = albedo * fraction + Vec3(t * C.yellow, t * C.yellow, shade * C.blue);
  Real most = max(albedo.x, max(albedo.y, albedo.z));
  Real chroma = most - min(albedo.x, min(albedo.y, albedo.z));
  Real own = clamp(chroma / ((most + kNearlyBlack) * kSaturated), Real(0.0f), Real(1.0f)) * C.hue;
  // The added tone is a multiple of the surface's colour.
  Real added = (shade * (C.blue * kBlueTone) + t * C.yellow) / max(most, Real(1e-6f));
  Vec3 turned = albedo + Vec3(t, t, shade) * (chroma * kTurn);
  return sum + (turned * (fraction + added) - sum) * own;
}

FN void gooch_pixel(Int px, Int py) {
  Vec3 none = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  Real depth = near_depth(0, 0);
  Bool surface = is_surface(depth);
  if (!some(surface)) {
    store_lit(none);
    return;
  }
  Vec3 position = view_position(px, py, select(surface, depth, Real(1.0f)));
  Vec3 normal = unit_normal(near_normal(0, 0), position);
  Vec3 light = Vec3(Real(C.light_x), Real(C.light_y), Real(C.light_z));
  Real ao = clean_ao(near_ao(0, 0));
  if (C.occlusion != 1.0f) ao = stronger_ao(ao, C.occlusion);
  Real t = mad(dot(normal, light), Real(0.5f), Real(0.5f)) * clamp(ao, Real(0.0f), Real(1.0f));
  Vec3 color = tone_of(display_albedo(), t);
  if (C.highlight > 0.0f) {
    Vec3 halfway = normalized(light + to_eye(position));
    Real fraction = pow(clamp(dot(normal, halfway), Real(0.0f), Real(1.0f)), Real(C.shininess)) * Real(C.highlight);
    color = color + (Vec3(Real(1.0f), Real(1.0f), Real(1.0f)) - color) * fraction;
  }
  if (C.values == kGoochLight) color = linear_from_display(color);
  store_lit(select(surface, finite_or_zero(color), none));
}
