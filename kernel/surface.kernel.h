// Whether two pixels show the same surface, in the dialect, for kernels that include it; for the host in
// host_surface.h.
//
// A pixel's plane, by its position and normal, predicts what every other pixel shows of it: inverse depth is linear in
// the picture in perspective, depth is in orthographic views. What a plane does not predict is measured as distance
// from it, in sizes of a pixel there. Along the line of sight that is as many lengths of a pixel's footprint on the
// surface, so that the measure is the same at any angle, and at any scale and resolution.

// Normals that were rounded, or interpolated over a coarse mesh, are wrong by so much, as a sine. On a surface seen at
// a grazing angle the next pixel is far away, and off the plane by that share of the way.
CONST float kMaxNormalError = 0.05f;
// So many times as steep as the one slope tells, of that by the normal and that by depths, the other may be. Of a way
// that is longer only that much counts, or else a step between planes seen at grazing angles would explain itself.
CONST float kMaxSteepening = 4.0f;
CONST float kOtherSurface = 1e6f;  // distance of surface and background, and of what is no number

// Inverse depth, or -depth in orthographic views, linear in the picture on every plane; least of all where there is no
// surface.
FN Real inverse_depth(Real depth) {
  Bool surface = is_surface(depth);
  if (F.orthographic != 0) return select(surface, Real(0.0f) - depth, Real(-1e30f));
  return select(surface, Real(1.0f) / max(depth, Real(1e-30f)), Real(0.0f));
}

// View-space size of a pixel at a depth, along its longer side.
FN Real pixel_size(Real depth) {
  Real spread = F.orthographic != 0 ? Real(1.0f) : depth;
  return max(abs(Real(F.ray_scale_x)), abs(Real(F.ray_scale_y))) * spread;
}

// How steeply the ray to the point `there` meets a plane through it, times the point's depth in perspective, above 0.
FN Real steepness(Vec3 normal, Vec3 there) {
  Real facing = F.orthographic != 0 ? normal.z : -dot(normal, there);
  Real depth = F.orthographic != 0 ? Real(1.0f) : -there.z;
  return max(abs(facing), depth * 1e-6f);
}

// How far the point `there`, at a distance `off` from a plane, may be off it, times its steepness: `near`, and what
// wrong normals explain of the way between the plane's point and `there`.
FN Real allowed_distance(Real off, Real near, Real steep, Vec3 normal, Vec3 way, Vec3 there) {
  // Along the line of sight to `there` the plane lies off / facing behind it; both are multiplied by its depth, to
  // spare a division.
  Real depth = F.orthographic != 0 ? Real(1.0f) : -there.z;
  Real facing = F.orthographic != 0 ? normal.z : -dot(normal, there);
  Real predicted = abs(off * depth - way.z * facing);
  return mad(near, steep, min(abs(way.z) * steep, predicted * kMaxSteepening) * kMaxNormalError);
}

// How far a view-space position lies off a pixel's plane, above 0 on the normal's side, in sizes of a pixel, of the
// smaller one of both: as normals say.
FN Real plane_distance_px(Vec3 position, Vec3 normal, Vec3 there) {
  return dot(there - position, normal) / max(pixel_size(min(-position.z, -there.z)), Real(1e-30f));
}

// How far it lies off the plane, likewise signed, in units of what counts as on it: `tolerance_px` sizes of a pixel and
// what wrong normals explain. The plane is that of `position` and its unit `normal`.
FN Real plane_distance(Vec3 position, Vec3 normal, Vec3 there, float tolerance_px) {
  Vec3 way = there - position;
  Real off = dot(way, normal);
  Real near = pixel_size(min(-position.z, -there.z)) * tolerance_px;
  Real allowed = near;
  Bool beyond = abs(off) > near;
  if (some(beyond)) {
    Real steep = steepness(normal, there);
    allowed = select(beyond, allowed_distance(off, near, steep, normal, way, there), near);
    off = select(beyond, off * steep, off);
  }
  return off / max(allowed, Real(1e-30f));
}

// How far each of two pixels lies off the other's plane, the larger of both distances; up to 1 they show the same
// surface. Background is on none.
FN Real surface_distance(Vec3 position, Vec3 normal, Vec3 there, Vec3 normal_there, float tolerance_px) {
  Vec3 way = there - position;
  Real own = dot(way, normal);
  Real its = dot(way, normal_there);
  Real nearer = min(-position.z, -there.z);
  Real near = pixel_size(nearer) * tolerance_px;
  Real off = max(abs(own), abs(its));
  Real allowed = near;
  Bool beyond = off > near;
  if (some(beyond)) {
    Real own_steep = steepness(normal, there);
    Real its_steep = steepness(normal_there, position);
    Real own_allowed = allowed_distance(own, near, own_steep, normal, way, there);
    Real its_allowed = allowed_distance(its, near, its_steep, normal_there, way, position);
    Real own_off = abs(own) * own_steep;
    Real its_off = abs(its) * its_steep;
    // The larger of both quotients.
    Bool is_own = own_off * its_allowed > its_off * own_allowed;
    off = select(beyond, select(is_own, own_off, its_off), off);
    allowed = select(beyond, select(is_own, own_allowed, its_allowed), near);
  }
  // What is no number is on none, too; max may overlook it.
  return select(nearer > 0.0f && is_finite(own + its), off / max(allowed, Real(1e-30f)), Real(kOtherSurface));
}

// How much two pixels belong together, for filters: fully up to a distance of 1, from 2 on not.
FN Real joint_of(Real distance) { return clamp(Real(2.0f) - distance, Real(0.0f), Real(1.0f)); }
