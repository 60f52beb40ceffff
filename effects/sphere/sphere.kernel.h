// Computes occlusion from points in a sphere around each pixel: it is the fraction of the points that are behind the
// depth buffer's surface. Based on [Lajzer and Nottingham], "Pass 2" and listing 1. Each parameter removes one of the
// simplifications that the paper's conclusions name.
//
// Whether a sample counts depends on the pixel that it falls into. Positions are therefore computed only by operations
// that round identically on every machine, so not by rsqrt.
IN_REAL(depth)
IN_VECTOR(normal)
OUT_REAL(ao)

// Min difference in depth at which a surface counts as nearer. Differs: the listing compares with 0. On a plane that
// faces the camera, depths in float vary in their last bits, where the paper's fixed-point depth buffer had equal
// numbers.
CONST float kWindowRounding = 4.7683716e-7f;  // 2^-21 of the range of window depth, 8 steps of a 24-bit buffer
CONST float kDepthRounding = 2e-6f;           // relative to the depth: 16 to 32 ulp of a float
// Min depth of a sample, relative to the pixel's depth. Samples nearer than that or behind the camera are moved to it.
CONST float kMinDepth = 1e-3f;

// Converts random bits to a number in [-1, 1).
FN Real minus_one_to_one(Uint v) { return mad(to_real(v >> 8), Real(1.1920929e-7f), Real(-1.0f)); }  // 2^-23

// Returns the random vector of a pixel, from a tile that repeats (if C.noise_size > 0). It is not a unit vector, and
// never 0.
FN Vec3 random_vector(Int px, Int py) {
  Int x = px;
  Int y = py;
  if (C.noise_size > 0.0f) {
    Real size = Real(C.noise_size);
    x = to_int(to_real(px) - size * floor((to_real(px) + 0.5f) / size));
    y = to_int(to_real(py) - size * floor((to_real(py) + 0.5f) / size));
  }
  Uint seed = scrambled(to_uint(x) ^ scrambled(to_uint(y) + Uint(0x9e3779b9u)));
  Uint second = scrambled(seed + Uint(1u));
  Uint third = scrambled(seed + Uint(2u));
  // An offset of half a step, so that the vector is not 0.
  return Vec3(minus_one_to_one(seed) + 5.9604645e-8f, minus_one_to_one(second), minus_one_to_one(third));
}

// Returns the depth that is compared: window depth or linear depth.
FN Real compared_depth(Real depth) {
  if (C.linear != 0) return depth;
  Real between = clamp(depth, Real(C.near_depth), Real(C.far_depth));  // clipped by near and far plane
  return Real(C.window_one) - Real(C.window_inverse) / between;
}

// Returns the weight of a sample whose occluder is `nearer` in front of the pixel.
FN Real range_weight(Real nearer, Real limit) {
  if (C.range == kSphereRangeHard) return select(nearer < limit, Real(1.0f), Real(0.0f));
  Real t = limit / max(nearer, limit);  // 1 within the limit
  return t * t * (3.0f - (t + t));
}

// Returns how much a sample is occluded that is `behind` a surface: all or nothing, or a ramp in front of the surface.
FN Real occlusion_by_depth(Real behind, Real rounding, Real ramp) {
  if (C.softness > 0.0f) return clamp(behind / ramp + 1.0f, Real(0.0f), Real(1.0f));
  return select(behind > rounding, Real(1.0f), Real(0.0f));
}

// Returns the occlusion of a sample, blended with a constant: fully where it is farther behind the surface than
// `limit`, half where it is as far in front of it [Mittring 2007].
FN Real blended_with_constant(Real occlusion, Real behind, Real limit) {
  Real relative = clamp(behind / limit, Real(-1.0f), Real(1.0f));
  Real part = 0.5f * (abs(relative) + max(relative, Real(0.0f)));
  return mad(Real(C.beyond) - occlusion, part, occlusion);
}

// Returns the visibility if `occluded` of `count` samples are occluded.
FN Real visibility_from_counts(Real occluded, Real count) {
  Real fraction = occluded / max(count, Real(1.0f));
  Real mapped = C.quadratic != 0 ? fraction * fraction : fraction;
  mapped = select(occluded < Real(C.threshold) * count, Real(0.0f), mapped);
  Real visibility = max(Real(0.0f), 1.0f - mapped * Real(C.strength));
  return clamp(visibility * Real(C.gain) + Real(C.offset), Real(0.0f), Real(1.0f));
}

// Returns sample point i in view space, reflected at the pixel's vector.
FN Vec3 sample_point(int i, Vec3 mirror, Vec3 twice_mirror, Vec3 normal) {
  Vec3 v = Vec3(Real(C.points[3 * i]), Real(C.points[3 * i + 1]), Real(C.points[3 * i + 2]));
  if (C.reflect != kSphereReflectNone) v = v + twice_mirror * dot(mirror, v);
  if (C.hemisphere != 0) v = v * select(dot(v, normal) < 0.0f, Real(-1.0f), Real(1.0f));
  return v;
}

FN Real visibility_at(Int px, Int py, Real depth) {
  Real x = to_real(px) + 0.5f;
  Real y = to_real(py) + 0.5f;
  // Relative to the principal point, from which points move away as they come nearer.
  Real from_centre_x = x + Real(F.ray_offset_x / F.ray_scale_x);
  Real from_centre_y = y + Real(F.ray_offset_y / F.ray_scale_y);
  Real spread = F.orthographic != 0 ? Real(1.0f) : depth;
  // The radius in pixels along x and y, and in scene units.
  Real radius_x = Real(C.radius_px);
  Real radius_y = Real(C.radius_px);
  Real radius = Real(C.radius_px * F.ray_scale_x) * spread;
  if (C.world_radius != 0) {
    radius = Real(C.reach);
    radius_x = radius / (Real(F.ray_scale_x) * spread);
    radius_y = radius / (Real(-F.ray_scale_y) * spread);
  }
  Vec3 position = view_position(px, py, depth);
  Vec3 normal = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  if (C.hemisphere != 0 || C.reflect == kSphereReflectNormal) normal = unit_normal(near_normal(0, 0), position);
  Vec3 mirror = normal;
  if (C.reflect == kSphereReflectRandom) mirror = random_vector(px, py);
  Vec3 twice_mirror = mirror * (Real(-2.0f) / max(dot(mirror, mirror), Real(1e-30f)));

  Real own = compared_depth(depth);
  Real rounding = C.linear != 0 ? depth * kDepthRounding : Real(kWindowRounding);
  Real limit = clamp((C.linear != 0 ? radius : radius_x) * Real(C.limit), Real(1e-30f), Real(1e30f));
  Real ramp = max((C.linear != 0 ? radius : radius_x) * Real(C.softness), Real(1e-30f));
  // Min height of an occluder above the pixel's plane.
  Real min_height = mad(radius, Real(C.bias), depth * kDepthRounding);
  Real occluded = Real(0.0f);
  Real count = Real(float(C.samples));
  for (int i = 0; i < C.samples; ++i) {
    Vec3 v = sample_point(i, mirror, twice_mirror, normal);
    Real sample_depth = depth;
    Real step_x = radius_x * v.x;
    Real step_y = -(radius_y * v.y);  // rows are counted from the top
    if (C.sample_z != 0) {
      sample_depth = max(depth - radius * v.z, depth * kMinDepth);
      if (F.orthographic == 0 && C.parallel == 0) {
        Real magnification = depth / sample_depth;
        step_x = mad(from_centre_x, magnification - 1.0f, step_x * magnification);
        step_y = mad(from_centre_y, magnification - 1.0f, step_y * magnification);
      }
    }
    // Differs: reads the nearest pixel. The paper does not say how it filters its texture.
    Real sample_x = floor(clamp(x + step_x, Real(-1.0f), Real(float(F.width))));
    Real sample_y = floor(clamp(y + step_y, Real(-1.0f), Real(float(F.height))));
    Int column = to_int(sample_x);
    Int row = to_int(sample_y);
    Real tap = load_depth(column, row);
    Real tap_depth = compared_depth(tap);
    // "if the sample is closer than the current pixel -> occlude" [listing 1]
    Real compared = C.sample_z != 0 ? compared_depth(sample_depth) : own;
    Real behind = compared - tap_depth;
    Real occlusion = occlusion_by_depth(behind, rounding, ramp);
    Bool occludes = is_surface(tap) && occlusion > 0.0f;
    if (C.hemisphere != 0) {
      Int inner_column = clamp(column, Int(0), Int(F.width - 1));  // of the pixel that was read
      Int inner_row = clamp(row, Int(0), Int(F.height - 1));
      Vec3 to_tap = view_position(inner_column, inner_row, tap) - position;
      occludes = occludes && dot(to_tap, normal) > min_height;
    }
    if (C.range == kSphereRangeHard || C.range == kSphereRangeSmooth)
      occlusion = occlusion * range_weight(own - tap_depth, limit);
    occlusion = select(occludes, occlusion, Real(0.0f));
    if (C.range == kSphereRangeBlend)
      occlusion = blended_with_constant(occlusion, select(is_surface(tap), behind, Real(-1e30f)), limit);
    if (C.skip_outside != 0) {
      Bool inside = sample_x >= 0.0f && sample_x < float(F.width) && sample_y >= 0.0f && sample_y < float(F.height);
      occlusion = select(inside, occlusion, Real(0.0f));
      count = count - select(inside, Real(0.0f), Real(1.0f));
    }
    occluded = occluded + occlusion;
  }
  return visibility_from_counts(occluded, count);
}

#include "kernel/occlusion.kernel.h"

FN void sphere_pixel(Int px, Int py) { store_visibility(px, py); }
