// Makes ray number F.round of each pixel: `ray`, a unit direction in view space, or 0 where the pixel has fewer rays.
// The directions are distributed about the axis of the hemisphere with a density proportional to the cosine. The points
// of the square that they map from are interleaved gradient noise [Jimenez 2014], which puts different values into
// neighbouring pixels, moved along R2 [Roberts 2018] from ray to ray. All of it is exact in integers, so that every
// machine traces the same rays.
IN_VECTOR(ray_offset)
IN_VECTOR(normal)
OUT_VECTOR(ray)
#include "effects/traced/joints.kernel.h"
#include "kernel/angles.kernel.h"

// Interleaved gradient noise is the fraction of 52.9829189 times that of 0.06711056 x + 0.00583715 y. All are in units
// of 2^-32 here.
FN Uint gradient_noise(Int px, Int py) {
  Uint inner = to_uint(px) * Uint(0x112e285cu) + to_uint(py) * Uint(0x017e8b20u);
  return inner * Uint(52u) + (inner >> 16) * Uint(0xfba1u);
}

// Returns the fraction of a pixel's neighbours in its row, or column, that show its surface. Those one pixel away and
// the pixel itself count twice, those two away once.
FN Real joined_fraction(bool along_row) {
  Real joints = near_traced_joints(0, 0);
  Real near = joint_of(joints, 0, along_row) + joint_before(0, along_row);
  Real far = joint_of(joints, 1, along_row) + joint_before(1, along_row);
  return mad(near + Real(float(kMaxJoint)), Real(2.0f), far) * Real(1.0f / (8.0f * float(kMaxJoint)));
}

// Returns the number of rays of a pixel. Those with all neighbours on their surface get C.rays, whose fraction an
// ordered dither of 4 x 4 pixels distributes.
FN Real ray_count(Int px, Int py) {
  Uint x = to_uint(px) & Uint(3u);
  Uint y = to_uint(py) & Uint(3u);
  Uint a = x ^ y;
  Uint order = ((a & Uint(1u)) << 3) | ((y & Uint(1u)) << 2) | (a & Uint(2u)) | (y >> 1);
  Real threshold = fract((to_real(to_signed(order)) + 0.5f) * 0.0625f + Real(C.dither));
  Real wanted = Real(C.rays) / (joined_fraction(true) * joined_fraction(false));
  return min(floor(wanted + threshold), Real(C.max_rays));
}

// Returns the direction about +z for a point of the unit square, by the concentric map [Shirley and Chiu 1997].
FN Vec3 cosine_direction(Real u, Real v) {
  Real a = mad(u, Real(2.0f), Real(-1.0f + 5.9604645e-8f));  // never 0: half a step off
  Real b = mad(v, Real(2.0f), Real(-1.0f + 5.9604645e-8f));
  Bool wide = abs(a) > abs(b);
  Real radius = select(wide, a, b);
  Real ratio = select(wide, b, a) / radius;
  Real sine = sine_of_quarter_turns(ratio * 0.5f);
  Real cosine = sqrt(mad(-sine, sine, Real(1.0f)));
  return Vec3(radius * select(wide, cosine, sine), radius * select(wide, sine, cosine),
              sqrt(max((Real(1.0f) - radius) * (Real(1.0f) + radius), Real(0.0f))));
}

// Returns the vector in the basis with the third axis n [Duff et al. 2017].
FN Vec3 turned_to(Vec3 n, Vec3 v) {
  Real sign = select(n.z < 0.0f, Real(-1.0f), Real(1.0f));
  Real a = Real(-1.0f) / (sign + n.z);
  Real b = n.x * n.y * a;
  Real x = mad(v.x, mad(sign * n.x, n.x * a, Real(1.0f)), mad(v.y, b, v.z * n.x));
  Real y = mad(v.x, sign * b, mad(v.y, mad(n.y, n.y * a, sign), v.z * n.y));
  Real z = mad(v.x, -sign * n.x, mad(v.y, -n.y, v.z * n.z));
  return Vec3(x, y, z);
}

FN void traced_rays_pixel(Int px, Int py) {
  Vec3 axis = load_ray_offset(px, py);
  Real size = max(max(abs(axis.x), abs(axis.y)), abs(axis.z));
  Bool traced = size > 0.0f && Real(float(F.round)) < ray_count(px, py);
  Vec3 ray = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  if (some(traced)) {
    Uint index = to_uint(Int(F.round + (F.round < C.own_rays ? C.first_ray : C.first_further_ray)));
    Uint step = Uint(0xc13fa9a9u) * index;
    Uint other_step = Uint(0x91e10da6u) * index;
    Real u = unit_real(gradient_noise(px, py) + step);
    Real v = unit_real(gradient_noise(py + Int(47), px + Int(17)) + other_step);
    axis = axis * (Real(1.0f) / max(size, Real(1e-37f)));
    if (C.normal == kTracedShading) axis = load_normal(px, py);
    axis = axis * (Real(1.0f) / sqrt(max(dot(axis, axis), Real(1e-30f))));
    ray = turned_to(axis, cosine_direction(u, v));
  }
  store_ray(select(traced, ray, Vec3(Real(0.0f), Real(0.0f), Real(0.0f))));
}
