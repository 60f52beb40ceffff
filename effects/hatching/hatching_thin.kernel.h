// Directions along parts of a surface that are only a few lines wide, such as fins, wires and rings, from the plane
// hatching_break. Included once per kernel.
//
// Let L be the length of the way through a pixel until the surface ends, in a direction. In a strip at the angle a that
// is w wide, L = w / |sin(angle - a)|. So the inverse squares of L to the right, down and along both diagonals give
// w and (cos 2a, sin 2a) by sums.
IN_REAL(hatching_break)

CONST float kThinWeight = 1.5f;  // of the direction of a thin part, relative to a distinct curvature

FN Bool ends_right(int i, int j) {
  Real ends = near_hatching_break(i, j);
  return ends - floor(ends * 0.5f) * 2.0f > 0.5f;
}
FN Bool ends_below(int i, int j) { return near_hatching_break(i, j) > 1.5f; }

// Returns whether the surface ends between the pixel (i, j) and the next one, `down` rows below and `right` columns to
// the right, each 0 or 1; down is -1 for the upper right.
FN Bool ends_between(int i, int j, int right, int down) {
  if (right == 0) return ends_below(i, j);
  if (down == 0) return ends_right(i, j);
  return ends_right(i, j) || ends_below(i + 1, down > 0 ? j : j - 1);
}

// Returns the inverse square of the way through the pixel in one direction; 0 if it is longer than C.thin_px.
FN Real inverse_squared_way(int right, int down) {
  Bool forward = Bool(true);
  Bool backward = Bool(true);
  Real pixels = Real(1.0f);
  for (int k = 0; k < C.thin_px; ++k) {
    forward = forward && !ends_between(k * right, k * down, right, down);
    backward = backward && !ends_between(-(k + 1) * right, -(k + 1) * down, right, down);
    if (!some(forward || backward)) break;
    pixels = pixels + select(forward, Real(1.0f), Real(0.0f)) + select(backward, Real(1.0f), Real(0.0f));
  }
  float squared = float(right * right + down * down);
  return select(pixels <= float(C.thin_px), Real(1.0f) / (pixels * pixels * squared), Real(0.0f));
}

// Returns the weighted direction of the thin part that contains the pixel, or 0.
FN Vec2 thin_direction() {
  Real across = inverse_squared_way(1, 0);
  Real along = inverse_squared_way(0, 1);
  Real falling = inverse_squared_way(1, 1);
  Real rising = inverse_squared_way(1, -1);
  Real x = along - across;
  Real y = rising - falling;
  Real sum = (across + along + falling + rising) * 0.5f;
  // Full weight up to half of C.thin_px, none from 0.9 on.
  Real width = Real(1.0f) / sqrt(max(sum, Real(1e-12f)));
  Real thin = clamp((Real(0.9f) - width * C.inverse_thin) * 2.5f, Real(0.0f), Real(1.0f));
  Real distinct = min((x * x + y * y) / max(sum * sum, Real(1e-24f)), Real(1.0f));
  return Vec2(x, y) * (thin * distinct * kThinWeight / max(sum, Real(1e-12f)));
}
