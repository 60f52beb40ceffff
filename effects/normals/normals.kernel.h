// Computes normals from depth alone. Of a pixel's two neighbours along a row, and of those along a column, it uses the
// one on the pixel's own surface: the side whose two pixels best predict the depth of this one. Based on [Wu 2020].
//
// The prediction is exact for planes: -1 / depth in perspective, depth in orthographic views, is affine in the picture.
// Where neither side has two pixels of a surface, the neighbour that is nearer in depth is used; where there is none,
// the normal faces the camera. Background has normal 0.
IN_REAL(depth)
OUT_VECTOR(normal)

CONST float kNever = 3e38f;

// Returns depth (orthographic) or -1 / depth (perspective), which are affine on planes; kNever where there is no
// surface.
FN Real affine(int i, int j) {
  Real depth = near_depth(i, j);
  Bool surface = is_surface(depth) && near_inside(i, j);
  Real value = F.orthographic != 0 ? depth : Real(-1.0f) / select(surface, depth, Real(1.0f));
  return select(surface, value, Real(kNever));
}

// Returns the error with which the next two pixels in direction (i, j) predict a pixel; large if they cannot.
FN Real error_of(Real here, int i, int j) {
  Real one = affine(i, j);
  Real two = affine(2 * i, 2 * j);
  Bool there = one < kNever;
  Bool tells = there && two < kNever;
  Real by_two = abs(one + one - two - here);
  // One pixel alone is worse than any two; the farther it is, the worse.
  Real by_one = Real(1e18f) + min(abs(one - here) * Real(1e18f), Real(1e30f));
  return select(tells, min(by_two, Real(1e17f)), select(there, by_one, Real(kNever)));
}

FN Vec3 position_at(Int px, Int py, int i, int j) {
  Real depth = near_depth(i, j);
  return view_position(px + Int(i), py + Int(j), select(is_surface(depth), depth, Real(1.0f)));
}

// Returns the step from a pixel to the next in direction (i, j) on its own surface; 0 if it is unknown.
FN Vec3 step_along(Int px, Int py, Vec3 position, Real here, int i, int j) {
  Real before = error_of(here, -i, -j);
  Real after = error_of(here, i, j);
  Vec3 none = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  Vec3 back = select(before < kNever, position - position_at(px, py, -i, -j), none);
  Vec3 on = select(after < kNever, position_at(px, py, i, j) - position, none);
  if (C.mean != 0) return back + on;
  return select(after < before, on, back);
}

FN void normals_pixel(Int px, Int py) {
  Real depth = near_depth(0, 0);
  Bool surface = is_surface(depth);
  Vec3 position = view_position(px, py, select(surface, depth, Real(1.0f)));
  Real here = affine(0, 0);
  Vec3 right = step_along(px, py, position, here, 1, 0);
  Vec3 down = step_along(px, py, position, here, 0, 1);
  // Steps are short: normalize them before they are multiplied.
  Real scale =
      Real(1.0f) /
      max(max(abs(right.x) + abs(right.y) + abs(right.z), abs(down.x) + abs(down.y) + abs(down.z)), Real(1e-30f));
  Vec3 n = cross(down * scale, right * scale);
  n = unit_normal(Vec3(finite_or_zero(n.x), finite_or_zero(n.y), finite_or_zero(n.z)), position);
  Real away = F.orthographic != 0 ? -n.z : dot(n, position);
  n = select(away > 0.0f, -n, n);
  store_normal(select(surface, finite_or_zero(n), Vec3(Real(0.0f), Real(0.0f), Real(0.0f))));
}
