// Lines drawn over the lit picture. Based on [Lajzer and Nottingham], listing 3, for mode `paper`; the rest is ours.
//
// Mode `robust`: each crossing of outline_refine is a piece of line one row (column) long. A pixel's cover is that of
// the piece that covers it most: how far its centre lies inside the line's width, counted from half a pixel outside, so
// that edges are antialiased. A line lies on the nearer surface: it reaches its whole width to that side, and half a
// pixel's antialiasing to the other. Pieces end round on the nearer surface, so that corners close, and do not
// reach around a corner onto what lies behind.
//
// Mode `paper`: a pixel is black where any of its 8 neighbours differs by 0.05 (1 - Z) in window depth Z or by 0.95 in
// the dot product of normals. Differs: background has the normal 0 and the depth 1, as a cleared buffer.
IN_REAL(depth)
IN_VECTOR(normal)
IN_REAL(outline_steep)
IN_REAL(outline_steep_slope)
IN_REAL(outline_flat)
IN_REAL(outline_flat_slope)
IN_REAL(outline_busy)
INOUT_COLOR(lit)
OUT_REAL(outline)

CONST float kLeastFacing = 0.01f;  // as in outline_find

FN Bool is_surface(Real depth) { return is_finite(depth) && depth > 0.0f; }

FN Real unit_clamp(Real v) { return clamp(v, Real(0.0f), Real(1.0f)); }

// Where a crossing lies between its two pixels.
FN Real place_of(Real v) {
  Real fraction = v - floor(v);
  return fraction + fraction - 0.5f;
}

FN Real nearness_of(Real depth) {
  Bool surface = is_surface(depth);
  depth = select(surface, max(depth, Real(1e-30f)), Real(1.0f));
  if (F.orthographic != 0) return select(surface, -depth, Real(-1e30f));
  return select(surface, Real(1.0f) / depth, Real(0.0f));
}

// What a piece of line covers of this pixel. (across, along): where the crossing's first pixel lies, from this one, across
// the line's main direction and along it. v and slope: as outline_refine has them. depth1, depth2: of the two pixels that
// it lies between. predicted: this pixel's plane's nearness at the crossing.
FN Real cover(Real v, Real slope, Real across, Real along, Real depth1, Real depth2, Real predicted) {
  Real side = mad(floor(v), Real(1.0f / 64.0f), Real(-65.0f / 64.0f));
  across = across + place_of(v);
  Real squared = mad(slope, slope, Real(1.0f));
  Real shrink = rsqrt(squared);
  Real off = (across - along * slope) * shrink;     // towards the first pixel's side
  Real past = abs(mad(across, slope, along)) * shrink;  // along the line
  past = max(past - squared * shrink * 0.5f, Real(0.0f));
  off = select(side < 0.0f, -off, off);
  Real nearer = select(side < 0.0f, depth2, depth1);
  side = abs(side);
  Real apart = mad(off, off, past * past);
  Real distance = apart * rsqrt(max(apart, Real(1e-20f)));
  Real wide = mad(side, Real(C.width_px * 0.5f), Real(C.width_px * 0.5f));  // onto the nearer side
  Real narrow = Real(C.width_px) - wide;                                     // onto the other
  Real allowed = Real(C.depth * F.ray_scale_x) * (abs(across) + abs(along) + 1.0f);
  Bool behind = predicted < -nearer - allowed;
  if (F.orthographic == 0) behind = predicted * nearer < Real(1.0f) - allowed;
  Real inner = min(unit_clamp(wide + 0.5f - distance), unit_clamp(off + narrow + 0.5f));
  Real outer = unit_clamp(narrow + 0.5f - distance);
  return select(v > 0.0f, select(off > 0.0f && !behind, inner, outer), Real(0.0f));
}

FN Real robust_cover(Int px, Int py) {
  Real covered = Real(0.0f);
  Real depth = near_depth(0, 0);
  Real own = nearness_of(depth);
  Bool surface = is_surface(depth);
  Vec3 n = near_normal(0, 0);
  Real sx = Real(0.0f);
  Real sy = Real(0.0f);
  if (F.orthographic != 0) {
    Real facing = max(n.z, Real(kLeastFacing));
    sx = n.x * Real(-F.ray_scale_x) / facing;
    sy = n.y * Real(-F.ray_scale_y) / facing;
  } else {
    Real z = select(surface, depth, Real(1.0f));
    Vec3 position = view_position(px, py, z);
    Real facing = -max(-dot(n, position), z * kLeastFacing);
    sx = n.x * Real(F.ray_scale_x) / facing;
    sy = n.y * Real(F.ray_scale_y) / facing;
  }
  sx = select(surface, finite_or_zero(sx), Real(0.0f));
  sy = select(surface, finite_or_zero(sy), Real(0.0f));
  for (int j = -C.reach; j <= C.reach; ++j) {
    if (!some(near_outline_busy(0, j) > 0.0f)) continue;
    Real fj = Real(float(j));
    for (int i = -C.reach; i <= C.reach; ++i) {
      Real fi = Real(float(i));
      Real v = near_outline_steep(i, j);
      if (some(v > 0.0f)) {
        Real predicted = own + mad(sx, fi + place_of(v), sy * fj);
        covered = max(covered, cover(v, near_outline_steep_slope(i, j), fi, fj, near_depth(i, j), near_depth(i + 1, j),
                                     predicted));
      }
      v = near_outline_flat(i, j);
      if (some(v > 0.0f)) {
        Real predicted = own + mad(sy, fj + place_of(v), sx * fi);
        covered = max(covered, cover(v, near_outline_flat_slope(i, j), fj, fi, near_depth(i, j), near_depth(i, j + 1),
                                     predicted));
      }
    }
  }
  return covered;
}

// Window depth in [0, 1].
FN Real window_depth(Real depth) {
  Real z = clamp(depth, Real(C.near_depth), Real(C.far_depth));
  Real window = (z - C.near_depth) / Real(C.far_depth - C.near_depth);
  if (F.orthographic == 0) window = window * Real(C.far_depth) / z;
  return select(is_surface(depth), window, Real(1.0f));
}

FN Real paper_cover() {
  Real base = window_depth(near_depth(0, 0));
  Vec3 base_normal = near_normal(0, 0);
  Real threshold = Real(C.paper_depth) * (Real(1.0f) - base);
  Real darkness = Real(0.0f);
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      if (i == 0 && j == 0) continue;
      Real apart = abs(window_depth(near_depth(i, j)) - base);
      Real alike = dot(near_normal(i, j), base_normal);
      Bool neither = !is_surface(near_depth(i, j)) && !is_surface(near_depth(0, 0));
      darkness = darkness + select(apart > threshold, Real(1.0f), Real(0.0f));
      darkness = darkness + select(alike < C.paper_normal && !neither, Real(1.0f), Real(0.0f));
    }
  return min(darkness, Real(1.0f));
}

FN void outline_pixel(Int px, Int py) {
  Real covered = Real(0.0f);
  if (C.mode == kOutlinePaper)
    covered = paper_cover();
  else
    covered = robust_cover(px, py);
  covered = covered * C.opacity;
  Vec3 line = Vec3(Real(C.r), Real(C.g), Real(C.b));
  Bool surface = is_surface(near_depth(0, 0));
  Vec3 lit = finite_or_zero(own_lit());
  lit = select(surface, lit, Vec3(Real(0.0f), Real(0.0f), Real(0.0f)));
  store_lit(lit * (Real(1.0f) - covered) + line * covered);
  store_outline(covered);
}
