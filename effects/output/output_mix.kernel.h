// Mixes light, background and lines: the part that output.kernel.h and output_beauty.kernel.h have in common.
//
// At a pixel without surface, `lit` is the light of a shadow that covers the fraction `shadow_catcher` of the pixel, or
// of surfaces in the average of several pictures that cover `cover` of it; or `cover_for_eye`, if they are averaged
// perceptually. `coverage` is the alpha of a picture of another renderer: what is not a line has at most this alpha.
// Lines of the colour `line` that cover the fraction `outline` are drawn over the finished picture.
#include "effects/output/output_light.kernel.h"

// Declared on other lines than the outputs of the files that include this one: see PLANE in kernel/glsl.h.
IN_COLOR(lit)
IN_REAL(depth)
IN_REAL(outline)
IN_COLOR(line)
IN_REAL(cover)
IN_REAL(cover_for_eye)
IN_REAL(shadow_catcher)
IN_COLOR(sky)
IN_REAL(coverage)

FN Real fraction_of(Real v) { return clamp(v, Real(0.0f), Real(1.0f)); }

// What is in front of the background at a pixel.
struct Front {
  Bool surface;
  Bool as_square_roots;  // averaged perceptually
  Real covered;          // fraction of the pixel that `lit` covers, if there is no surface
  Vec3 light;            // of that, not multiplied by the fraction, exposed by C.gain
};

// `shade`: fraction that the shadow on the ground covers.
FN Front front_of(Real shade) {
  Bool surface = is_finite(near_depth(0, 0));
  Real of_eye = fraction_of(near_cover_for_eye(0, 0));
  Real of_light = max(fraction_of(near_cover(0, 0)), shade);
  Real covered = max(of_eye, of_light);
  Real fraction = select(surface || covered == Real(0.0f), Real(1.0f), covered);
  return Front(surface, of_eye > of_light, covered, near_lit(0, 0) * (Real(C.gain) / fraction));
}

// Returns the background's light at a row: `color`, darkened upwards by the gradient.
FN Vec3 background_at(Int py, Vec3 color) {
  if (C.gradient > 0.0f) {
    Real height = mad(to_real(py - Int(C.first_row)) + 0.5f, Real(-C.one_over_height), Real(1.0f));
    color = color * mad(clamp(height, Real(0.0f), Real(1.0f)), Real(-C.gradient), Real(1.0f));
  }
  return color;
}

// Light with straight alpha.
struct Mixed {
  Vec3 light;
  Real alpha;
};

// Returns the finished light of a pixel: `light`, that of a surface or of what covers the fraction front.covered, over
// the background `beyond`; and lines over that.
FN Mixed mixed_with_background_and_lines(Front front, Vec3 light, Vec3 beyond) {
  Real covered = front.covered;
  Real behind = (Real(1.0f) - covered) * Real(C.background_alpha);
  Real alpha = covered + behind;
  Real scale = Real(1.0f) / select(alpha > 0.0f, alpha, Real(1.0f));
  Vec3 both = light * (covered * scale) + beyond * (behind * scale);
  both = select(front.as_square_roots, mixed_as_square_roots(beyond, light, covered * scale), both);
  light = select(front.surface, light, both);
  alpha = select(front.surface, Real(1.0f), alpha) * fraction_of(near_coverage(0, 0));
  Real line = fraction_of(near_outline(0, 0));
  Bool lines = line > 0.0f;
  alpha = select(lines, line + (Real(1.0f) - line) * alpha, alpha);
  Vec3 drawn = mixed_as_square_roots(light, clamped_to_0(finite_or_zero(near_line(0, 0))),
                                     line / select(lines, alpha, Real(1.0f)));
  return Mixed(select(lines, drawn, light), alpha);
}
