// Whether two pixels show the same surface, in the kernel dialect, for kernels that include it; host_surface.h has it
// for the host.
//
// The plane through a pixel's position and normal predicts the depth at every other pixel: inverse depth is linear in
// the picture in perspective, depth is in orthographic views. The deviation is the distance from the plane, in sizes of
// a pixel there. Along the line of sight this equals the deviation in lengths of a pixel's footprint on the surface, so
// the measure is independent of angle, scale and resolution.

// Max error, as a sine, of normals that are rounded, or interpolated over a coarse mesh. On a surface seen at a grazing
// angle the next pixel is far away, and off the plane by this fraction of the way.
CONST float kMaxNormalError = 0.05f;
// Max ratio of the depth change along the way to the one that the normal predicts. Of a longer way only that much
// counts, or else a step between planes seen at grazing angles would explain itself.
CONST float kMaxSteepening = 4.0f;
CONST float kOtherSurface = 1e6f;  // distance between surface and background, and for NaN

// Returns inverse depth, or -depth in orthographic views, which is linear in the picture on every plane; the min value
// where there is no surface.
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

// Returns how steeply the ray to the point `there` meets a plane through it, times the point's depth in perspective, >
// 0.
FN Real steepness(Vec3 normal, Vec3 there) {
  Real facing = F.orthographic != 0 ? normal.z : -dot(normal, there);
  Real depth = F.orthographic != 0 ? Real(1.0f) : -there.z;
  return max(abs(facing), depth * 1e-6f);
}

// Returns the allowed distance of the point `there`, which is `off` from a plane, times its steepness: `near`, and what
// wrong normals explain of the way between the plane's point and `there`.
FN Real allowed_distance(Real off, Real near, Real steep, Vec3 normal, Vec3 way, Vec3 there) {
  // Along the line of sight to `there` the plane is off / facing behind it; both are multiplied by its depth, to avoid
  // a division.
  Real depth = F.orthographic != 0 ? Real(1.0f) : -there.z;
  Real facing = F.orthographic != 0 ? normal.z : -dot(normal, there);
  Real predicted = abs(off * depth - way.z * facing);
  return mad(near, steep, min(abs(way.z) * steep, predicted * kMaxSteepening) * kMaxNormalError);
}

// Returns the signed distance of a view-space position from a pixel's plane, > 0 on the side of the normal, in sizes of
// a pixel, the smaller of both.
FN Real plane_distance_px(Vec3 position, Vec3 normal, Vec3 there) {
  return dot(there - position, normal) / max(pixel_size(min(-position.z, -there.z)), Real(1e-30f));
}

// Returns the same signed distance in units of the allowed distance: `tolerance_px` sizes of a pixel and what wrong
// normals explain. The plane is that of `position` and its unit `normal`.
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

// Returns the distances of two pixels from each other's planes, the larger of both; up to 1 they show the same surface.
// Background is on no surface.
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
  // NaN is on no surface either; max may miss it.
  return select(nearer > 0.0f && is_finite(own + its), off / max(allowed, Real(1e-30f)), Real(kOtherSurface));
}

// Returns the weight of a pixel of that distance in filters: 1 up to a distance of 1, 0 from 2 on.
FN Real same_surface_weight(Real distance) { return clamp(Real(2.0f) - distance, Real(0.0f), Real(1.0f)); }
