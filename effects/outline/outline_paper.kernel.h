// Writes the fraction of each pixel that lines cover, in mode `paper`. Based on [Lajzer and Nottingham], listing 3: a
// pixel is black if any of its 8 neighbours differs by more than 0.05 (1 - Z) in window depth Z, or if the dot product
// of their normals is below 0.95.
//
// Differs: background has the normal 0 and the depth 1, like a cleared buffer.
IN_REAL(depth)
IN_VECTOR(normal)
OUT_REAL(outline)

// Returns window depth in [0, 1], as in the paper's depth buffer.
FN Real window_depth(int i, int j) {
  Real depth = near_depth(i, j);
  Real z = clamp(depth, Real(C.near_depth), Real(C.far_depth));
  Real window = (z - C.near_depth) / Real(C.far_depth - C.near_depth);
  if (F.orthographic == 0) window = window * Real(C.far_depth) / z;
  return select(depth > 0.0f && is_finite(depth), window, Real(1.0f));
}

FN void outline_paper_pixel(Int px, Int py) {
  Real base = window_depth(0, 0);
  Vec3 base_normal = near_normal(0, 0);
  Real threshold = Real(C.paper_depth) * (Real(1.0f) - base);
  Bool surface = is_surface(near_depth(0, 0));
  Bool dark = base > 2.0f;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      if (i == 0 && j == 0) continue;
      Bool either = surface || is_surface(near_depth(i, j));
      dark = dark || abs(window_depth(i, j) - base) > threshold;
      dark = dark || (dot(near_normal(i, j), base_normal) < C.paper_normal && either);
    }
  store_outline(select(dark, Real(C.opacity), Real(0.0f)));
}
