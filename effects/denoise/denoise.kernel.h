// What all passes of `denoise` share: five pixels in a row, [1 2 2 2 1]/8, as far as they lie on one surface; in each
// round twice as far apart, as in the a-trous filter of [Dammertz et al. 2010].
//
// Differs: the weights are a box of 4 times one of 2, not a spline's. What repeats every 4 pixels, as the noise of
// techniques with a 4x4 tile of random vectors does, is gone after one round. And what a neighbour on another surface
// does not give, the pixel itself does, so that two pixels give each other the same and the mean stays.
IN_REAL(depth)
IN_VECTOR(normal)

// The misfit of two surfaces is 1 at the distance and angle that people set; up to there they join fully, from 2 on
// not.
CONST float kNoJoint = 2.0f;
// Normals that were rounded, or interpolated over a coarse mesh, are off by a few degrees. On a surface seen at a
// grazing angle the next pixel is far away, and off the plane by that share of the way.
CONST float kSlack = 0.05f;

// A pixel that none beside it in its row (column) joins, of a fold or a wire one pixel wide, keeps the noise of its few
// samples. From the second round on, when what is beside it is smooth, it may be so many times as bright as that, and
// so much darker.
CONST float kAlone = 0.02f;  // sum of weights
CONST float kBrighter = 1.35f;
CONST float kDarker = 0.75f;

// The weight of the neighbour (i, j) pixels right and down, of at most `most`.
FN Real weight_of(int i, int j, Int px, Int py, Vec3 position, Vec3 normal, Bool surface, float most) {
  Real depth = near_depth(i, j);
  Vec3 other_normal = near_normal(i, j);
  Vec3 way = view_position(px + Int(i), py + Int(j), depth) - position;
  Real off_own = abs(dot(way, normal));
  Real off_other = abs(dot(way, other_normal));
  Real off = max(off_own, off_other);
  Real spread = F.orthographic != 0 ? Real(1.0f) : min(depth, -position.z);
  Real distance = mad(abs(way.z), Real(kSlack), Real(F.ray_scale_x * C.distance) * spread);
  Real turned = (1.0f - dot(normal, other_normal)) * Real(C.turn);
  Real misfit = max(turned, off / max(distance, Real(1e-30f)));
  Real joint = clamp(Real(kNoJoint) - misfit, Real(0.0f), Real(1.0f));
  // What is no number, of a normal or a position, is no joint; max overlooks it.
  Bool number = is_finite(turned + (off_own + off_other));
  return select(number && surface && is_surface(depth) && near_inside(i, j), joint * Real(most), Real(0.0f));
}

// Whether neither of the pixels (i, j) to the right and below, and to the left and above, joins this one of a surface.
FN Bool is_alone(int i, int j, Int px, Int py, Vec3 position, Vec3 normal, Bool surface) {
  return weight_of(-i, -j, px, py, position, normal, surface, 1.0f) +
             weight_of(i, j, px, py, position, normal, surface, 1.0f) <
         kAlone;
}

FN Bool beside(int i, int j) { return is_surface(near_depth(i, j)) && near_inside(i, j); }

FN Real at_most(Real light, Real before, Real after, Bool has_before, Bool has_after) {
  return min(light, max(select(has_before, before, Real(0.0f)), select(has_after, after, Real(0.0f))) * kBrighter);
}

// Light, held to that of the pixels before and after.
FN Vec3 light_beside(Vec3 light, Vec3 before, Vec3 after, Bool has_before, Bool has_after) {
  Vec3 most = Vec3(at_most(light.x, before.x, after.x, has_before, has_after),
                   at_most(light.y, before.y, after.y, has_before, has_after),
                   at_most(light.z, before.z, after.z, has_before, has_after));
  return select(has_before || has_after, most, light);
}

// Occlusion likewise.
FN Real ao_beside(Real ao, Real before, Real after, Bool has_before, Bool has_after) {
  Real least = min(select(has_before, before, Real(1.0f)), select(has_after, after, Real(1.0f))) * kDarker;
  return select(has_before || has_after, max(ao, least), ao);
}
