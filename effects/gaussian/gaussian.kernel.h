// What both passes of `gaussian` share: one step of a 3x3 Gaussian, [1 2 1]/4 along one axis of the picture. Based on
// [Lajzer and Nottingham], "Pass 3"; the paper names the size and not the weights, which are the binomial ones here.
//
// Written as differences to the pixel itself, so that what is equal stays equal to the bit, and so that a neighbour
// that does not count leaves its weight to the pixel.
IN_REAL(depth)
IN_VECTOR(normal)

// With `edges`, a neighbour counts fully up to one pixel's size off the pixel's plane, and not at all from two on. The
// next pixel of one surface is off by its curvature alone, which is far less.
CONST float kSameSurface = 1.0f;
CONST float kOtherSurface = 2.0f;

// How much a neighbour's occlusion belongs to this pixel: plane distance over the size of a pixel, from either side.
// `position` and `normal` are this pixel's, `there` and `other` the neighbour's. Background (no finite depth) never
// counts.
FN Real belongs(Vec3 position, Vec3 normal, Vec3 there, Vec3 other, Real pixel_size) {
  Vec3 way = there - position;
  Real off = max(abs(dot(way, normal)), abs(dot(way, other))) / pixel_size;
  Bool both = is_finite(position.z) && is_finite(there.z);
  return select(both, clamp(Real(kOtherSurface) - off, Real(0.0f), Real(kOtherSurface - kSameSurface)), Real(0.0f));
}

// View-space extent of a pixel at a depth.
FN Real pixel_size_at(Real depth) {
  Real spread = F.orthographic != 0 ? Real(1.0f) : depth;
  return max(Real(F.ray_scale_x) * spread, Real(1e-30f));
}

// The pixel's value and its two neighbours' joined.
FN Real joined(Real before, Real here_ao, Real after, Real weight_before, Real weight_after) {
  Real change = mad(weight_before, before - here_ao, weight_after * (after - here_ao));
  return mad(change, Real(C.side), here_ao);
}
