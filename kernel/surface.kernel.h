// Decides whether two pixels show the same surface, in the kernel dialect. Kernels that need it include this file;
// host_surface.h provides the same functions on the host.
//
// The plane through a pixel's position and normal predicts the depth of every other pixel, since inverse depth
// (orthographic views: depth) is linear in the picture. The deviation is the other point's distance from the plane, in
// pixel sizes at that depth. It equals the deviation along the line of sight, divided by the length of a pixel's
// footprint on the surface; so the measure does not depend on angle, scale or resolution.

// Max error, as a sine, of normals that are rounded or interpolated over a coarse mesh. On a surface seen at a grazing
// angle the next pixel's point is far away, and may be off the plane by this fraction of its distance.
CONST float kMaxNormalError = 0.05f;
// Max ratio of the actual depth change between two points to the change that the normal predicts. A larger change
// counts only up to this ratio; otherwise a depth step between planes seen at grazing angles would increase its own
// tolerance.
CONST float kMaxSteepening = 4.0f;
CONST float kOtherSurface = 1e6f;  // distance if one of the pixels is background or a value is NaN

// Returns inverse depth, or -depth in orthographic views; on every plane this is linear in the picture. Where there is
// no surface, returns a value that is not above that of any surface: 0, or -1e30 in orthographic views.
FN Real inverse_depth(Real depth) {
  Bool surface = is_surface(depth);
  if (F.orthographic != 0) return select(surface, Real(0.0f) - depth, Real(-1e30f));
  return select(surface, Real(1.0f) / max(depth, Real(1e-30f)), Real(0.0f));
}

// Returns the view-space size of a pixel at a depth, along its longer side.
FN Real pixel_size(Real depth) {
  Real spread = F.orthographic != 0 ? Real(1.0f) : depth;
  return max(abs(Real(F.ray_scale_x)), abs(Real(F.ray_scale_y))) * spread;
}

// Returns the magnitude of the cosine between a plane's normal and the view ray through the point `there`, scaled by
// the length of that ray in perspective; at least 1e-6 times the depth (orthographic: 1e-6).
FN Real steepness(Vec3 normal, Vec3 there) {
  Real facing = F.orthographic != 0 ? normal.z : -dot(normal, there);
  Real depth = F.orthographic != 0 ? Real(1.0f) : -there.z;
  return max(abs(facing), depth * 1e-6f);
}

// Returns the allowed distance of the point `there` from a plane, times `steep`, its steepness: the tolerance `near`
// plus the distance that inaccurate normals can cause. `off` is the actual distance, `way` the vector from the plane's
// point to `there`.
FN Real allowed_distance(Real off, Real near, Real steep, Vec3 normal, Vec3 way, Vec3 there) {
  // Along the view ray through `there`, the plane is farther than the point by off / facing. Both are multiplied by the
  // depth of `there`, to avoid a division.
  Real depth = F.orthographic != 0 ? Real(1.0f) : -there.z;
  Real facing = F.orthographic != 0 ? normal.z : -dot(normal, there);
  Real predicted = abs(off * depth - way.z * facing);
  return mad(near, steep, min(abs(way.z) * steep, predicted * kMaxSteepening) * kMaxNormalError);
}

// Returns the signed distance of the view-space point `there` from the plane of `position` and `normal`, > 0 on the
// side of the normal. The unit is the pixel size at the smaller of the two depths.
FN Real plane_distance_px(Vec3 position, Vec3 normal, Vec3 there) {
  return dot(there - position, normal) / max(pixel_size(min(-position.z, -there.z)), Real(1e-30f));
}

// Returns the same signed distance divided by the allowed distance, which is `tolerance_px` pixel sizes plus the
// distance that inaccurate normals can cause. `normal` is a unit vector.
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

// Returns the larger of the distances of two pixels' points from each other's planes, in units of the allowed distance:
// at most 1 if they show the same surface. Returns kOtherSurface if one is background or a value is NaN.
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
    // The larger of the two quotients.
    Bool is_own = own_off * its_allowed > its_off * own_allowed;
    off = select(beyond, select(is_own, own_off, its_off), off);
    allowed = select(beyond, select(is_own, own_allowed, its_allowed), near);
  }
  // `max` may ignore a NaN, so `own` and `its` are tested.
  return select(nearer > 0.0f && is_finite(own + its), off / max(allowed, Real(1e-30f)), Real(kOtherSurface));
}

// Returns the weight in a filter of a pixel at that surface_distance: 1 up to a distance of 1, 0 from 2 on.
FN Real same_surface_weight(Real distance) { return clamp(Real(2.0f) - distance, Real(0.0f), Real(1.0f)); }
