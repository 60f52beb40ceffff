// Mixes light, background and lines: the part that output.kernel.h and output_beauty.kernel.h have in common. It refers
// to the planes `outline`, `line` and those below, which they declare.

FN Vec3 clamped_to_0(Vec3 v) { return Vec3(max(v.x, Real(0.0f)), max(v.y, Real(0.0f)), max(v.z, Real(0.0f))); }

FN Real fraction_of(Real v) { return clamp(v, Real(0.0f), Real(1.0f)); }

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

// Returns the finished light of a pixel: that of a surface; or `light`, which covers the fraction `covered` of the
// pixel, over the background `beyond`; and lines over that.
FN Mixed mixed_with_background_and_lines(Bool surface, Vec3 light, Real covered, Bool as_square_roots, Vec3 beyond) {
  Real behind = (Real(1.0f) - covered) * Real(C.background_alpha);
  Real alpha = covered + behind;
  Real scale = Real(1.0f) / select(alpha > 0.0f, alpha, Real(1.0f));
  Vec3 both = light * (covered * scale) + beyond * (behind * scale);
  both = select(as_square_roots, mixed_as_square_roots(beyond, light, covered * scale), both);
  light = select(surface, light, both);
  alpha = select(surface, Real(1.0f), alpha);
  Real line = fraction_of(near_outline(0, 0));
  Bool lines = line > 0.0f;
  alpha = select(lines, line + (Real(1.0f) - line) * alpha, alpha);
  Vec3 drawn = mixed_as_square_roots(light, clamped_to_0(finite_or_zero(near_line(0, 0))),
                                     line / select(lines, alpha, Real(1.0f)));
  return Mixed(select(lines, drawn, light), alpha);
}
