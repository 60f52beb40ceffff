// Computes normals from depth alone. A pixel has two neighbours in its row and two in its column. Of each two, the
// kernel uses the one on the pixel's own surface, which it assumes to be on the side whose next two pixels,
// extrapolated, best predict the depth of the pixel. Based on [Wu 2020].
//
// The prediction is exact for planes: on a plane, -1 / depth (perspective) or depth (orthographic) is affine in pixel
// coordinates. If neither side has two pixels that show a surface, the neighbour closer in depth is used. If no
// neighbour shows a surface, the normal faces the camera. Background has normal 0.
IN_REAL(depth)
OUT_VECTOR(normal)

CONST float kUnknown = 3e38f;  // a value or an error that cannot be computed

// Returns, for the pixel i columns right and j rows down, depth (orthographic) or -1 / depth (perspective), which is
// affine on planes; kUnknown where there is no surface.
FN Real affine(int i, int j) {
  Real depth = near_depth(i, j);
  Bool surface = is_surface(depth) && near_inside(i, j);
  Real value = F.orthographic != 0 ? depth : Real(-1.0f) / select(surface, depth, Real(1.0f));
  return select(surface, value, Real(kUnknown));
}

// Returns the error with which the next two pixels in direction (i, j) predict the value `here` of this pixel. It is
// larger if the second shows no surface, and kUnknown if the next one shows none.
FN Real error_of(Real here, int i, int j) {
  Real next = affine(i, j);
  Real second = affine(2 * i, 2 * j);
  Bool has_next = next < kUnknown;
  Bool has_second = has_next && second < kUnknown;
  Real by_two = abs(next + next - second - here);
  // Any prediction from one pixel has a larger error than every prediction from two.
  Real by_one = Real(1e18f) + min(abs(next - here) * Real(1e18f), Real(1e30f));
  return select(has_second, min(by_two, Real(1e17f)), select(has_next, by_one, Real(kUnknown)));
}

FN Vec3 position_at(Int px, Int py, int i, int j) {
  Real depth = near_depth(i, j);
  return view_position(px + Int(i), py + Int(j), select(is_surface(depth), depth, Real(1.0f)));
}

// Returns the change of position by one pixel in direction (i, j) on the surface of this pixel; 0 if neither neighbour
// shows a surface.
FN Vec3 step_along(Int px, Int py, Vec3 position, Real here, int i, int j) {
  Real before = error_of(here, -i, -j);
  Real after = error_of(here, i, j);
  Vec3 none = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  Vec3 backward = select(before < kUnknown, position - position_at(px, py, -i, -j), none);
  Vec3 forward = select(after < kUnknown, position_at(px, py, i, j) - position, none);
  if (C.mean != 0) return backward + forward;
  return select(after < before, forward, backward);
}

FN void normals_pixel(Int px, Int py) {
  Real depth = near_depth(0, 0);
  Bool surface = is_surface(depth);
  Vec3 position = view_position(px, py, select(surface, depth, Real(1.0f)));
  Real here = affine(0, 0);
  Vec3 right = step_along(px, py, position, here, 1, 0);
  Vec3 down = step_along(px, py, position, here, 0, 1);
  // Scales the differences of position first, since their product could underflow.
  Real scale =
      Real(1.0f) /
      max(max(abs(right.x) + abs(right.y) + abs(right.z), abs(down.x) + abs(down.y) + abs(down.z)), Real(1e-30f));
  Vec3 n = cross(down * scale, right * scale);
  n = unit_normal(Vec3(finite_or_zero(n.x), finite_or_zero(n.y), finite_or_zero(n.z)), position);
  Real facing_away = F.orthographic != 0 ? -n.z : dot(n, position);
  n = select(facing_away > 0.0f, -n, n);
  store_normal(select(surface, finite_or_zero(n), Vec3(Real(0.0f), Real(0.0f), Real(0.0f))));
}
