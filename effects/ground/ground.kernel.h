// Makes the ground under a model a shadow catcher: it becomes black, and `shadow_catcher`, its opacity over the
// background, is the fraction of the light that does not arrive.
IN_REAL(open_light)
IN_COLOR(indirect)
IN_REAL(depth)
IN_REAL(object_id)
INOUT_COLOR(lit)
OUT_REAL(shadow_catcher)

// Returns a fade from 0 to 1 without kinks at its ends.
FN Real eased(Real t) {
  t = clamp(t, Real(0.0f), Real(1.0f));
  return t * t * mad(t, Real(-2.0f), Real(3.0f));
}

FN void ground_pixel(Int px, Int py) {
  Real depth = near_depth(0, 0);
  Vec3 lit = own_lit();
  Real object = near_object_id(0, 0);
  Bool ground = is_surface(depth) && object == Real(C.object) && Real(C.object) >= 0.0f;
  Real open = near_open_light(0, 0);
  // Without indirect light: reflections from the model would cancel the contact shadow.
  Real arrives = dot(lit - clean_light(near_indirect(0, 0)), Vec3(Real(0.2126f), Real(0.7152f), Real(0.0722f))) /
                 select(open > 0.0f, open, Real(1.0f));
  Real shade = clamp((Real(1.0f) - arrives) * C.strength, Real(0.0f), Real(1.0f));
  // Above strength 1, between 1 - arrives and 1 - arrives^2: a factor would clip the shadow to black.
  shade = mad(shade * (Real(1.0f) - shade), Real(C.excess), shade);
  if (C.inverse_fade_distance > 0.0f) {
    // Fade over the outer half, so that a shadow longer than the ground has no visible end.
    Vec3 away = view_position(px, py, select(is_surface(depth), depth, Real(1.0f))) -
                Vec3(Real(C.middle_x), Real(C.middle_y), Real(C.middle_z));
    shade = shade * eased(mad(sqrt(dot(away, away)) * Real(C.inverse_fade_distance), Real(-2.0f), Real(2.0f)));
  }
  if (C.inverse_border > 0.0f) {
    // Towards a rounded rectangle that touches the borders of the picture: a superellipse of exponent 4.
    Real x = (to_real(px) + Real(0.5f - C.middle_px)) * C.inverse_half_width;
    Real y = (to_real(py) + Real(0.5f - C.middle_py)) * C.inverse_half_height;
    shade = shade * eased((Real(1.0f) - sqrt(sqrt(mad(x * x, x * x, y * y * (y * y))))) * Real(C.inverse_border));
  }
  shade = select(ground && open > 0.0f && is_finite(shade), shade, Real(0.0f));
  if (C.display != 0) shade = Real(1.0f) - display_from_linear(Real(1.0f) - shade);
  store_shadow_catcher(shade);
  store_lit(select(ground, Vec3(Real(0.0f), Real(0.0f), Real(0.0f)), finite_or_zero(lit)));
}
