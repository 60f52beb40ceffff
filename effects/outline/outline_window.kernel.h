// Window depth in [0, 1], as the depth buffer of [Lajzer and Nottingham] held it. Mode `paper`.
IN_REAL(depth)
OUT_REAL(outline_window)

FN void outline_window_pixel(Int px, Int py) {
  Real depth = near_depth(0, 0);
  Real z = clamp(depth, Real(C.near_depth), Real(C.far_depth));
  Real window = (z - C.near_depth) / Real(C.far_depth - C.near_depth);
  if (F.orthographic == 0) window = window * Real(C.far_depth) / z;
  store_outline_window(select(depth > 0.0f && is_finite(depth), window, Real(1.0f)));
}
