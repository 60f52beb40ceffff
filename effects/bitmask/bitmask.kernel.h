// Occlusion by slices of the hemisphere. In each slice, the kernel reads depths at increasing distances to both sides
// of the pixel; a surface above the tangent plane covers an interval of directions. Based on the visibility bitmask of
// [Therrien et al. 2023], with bits of equal cosine weight (bitmask_measure.kernel.h).
//
// With LAYERS, occluders are searched in all depth layers, else in the first. With LIGHT, they contribute indirect
// light. With BENT, the mean unoccluded direction is stored.
//
// The pixel that a tap reads does not have its centre exactly in the slice. The tap uses the pixel's true height above
// the tangent plane, and its distance along the slice. So a plane does not occlude itself, whatever its tilt.
//
// The choice of the pixel uses only operations that round identically on every machine, so no rsqrt.
IN_REAL_AND_LAYERS_IF(LAYERS, depth)
IN_VECTOR(normal)
IN_REAL(bitmask_mips)
OUT_REAL(ao)
OUT_VECTOR_IF(BENT, bent_normal, bent)
CONST bool kLayers = LAYERS == 1;
CONST bool kBent = BENT == 1;

#include "effects/bitmask/bitmask_measure.kernel.h"
#include "effects/bitmask/bitmask_noise.kernel.h"
#include "effects/bitmask/bitmask_sky.kernel.h"
#include "effects/hemisphere/hemisphere_light.kernel.h"

CONST float kDepthRounding = 2e-6f;   // relative to the depth: 16 to 32 ulp
CONST float kFirstStep = 1.3f;        // pixels; nearer taps would read the pixel itself
CONST float kMaxRadiusPx = 1e5f;      // pixels
CONST float kMinFacing = 0.1f;        // min N.V; smaller values are clamped
CONST float kStepTurn = 0.61803399f;  // change of the jitter of steps and of bits from one slice to the next
CONST float kEdgeOn = 2.5e-7f;   // squared cosine, the error of packed normals; below it a surface shows its front side
CONST float kBitJitter = 0.98f;  // range of the jitter of the borders between bits, in bits
CONST float kMaxLight = 1e18f;   // bound of the gathered light, so that it stays finite

// Data of the shaded pixel that all its taps share.
struct Origin {
  Real x, y, depth;
  Real height;              // height above the tangent plane per unit of depth, along the view ray: N . ray
  Real height_x, height_y;  // change of that height per pixel to the right and down, at depth 1
  Real one_over_nv;
};

// One side of a slice. The bit of a direction is k0 + k1 f(c) + k2 g(c), with c its cosine to the view direction.
struct Side {
  Real x, y;              // length of one step towards this side, in columns and rows
  Real along_x, along_y;  // steps per pixel to the right and down
  Real across;            // length of one step at depth 1, perpendicular to the view ray
  Real tangent;           // slope of the tangent plane along this side, towards the camera
  Real k0, k1, k2;
  Real low;  // min cosine to the view direction on this side: that of the tangent plane
};

// One tap: the centre of the pixel that it read, minus 0.5 (column and row, unless it read a mip level); the depth
// there; whether the tap is inside the picture.
struct Tap {
  Real x, y, depth;
  Bool inside;
};

// A vector from the shaded point to the surface at a tap: component towards the camera; square of the component
// perpendicular to that; squared length, > 0.
struct TapVector {
  Real to_eye, across2, squared;
};

// Returns the bit, as a real number, of the direction whose cosine to the view direction is c.
FN Real bit_of(Real c, Side side) {
  if (C.measure == kBitmaskUniform) return mad(angle_of_cosine(c), side.k2, side.k0);
  if (C.measure == kBitmaskSectors)
    return mad(sqrt(max(mad(-c, c, Real(1.0f)), Real(0.0f))), side.k1, mad(c, side.k2, side.k0));
  return mad(c * c, side.k1, mad(arc(c), side.k2, side.k0));
}

// Returns how many of the slice's 32 bits, as a real number, are on the side of negative angles. `sn`, `m`: as
// in slice_of().
FN Real bits_of_negative_side(Real sn, Real m) {
  if (C.measure == kBitmaskUniform) return Real(16.0f) - (Real(1.57079633f) - angle_of_cosine(sn)) * m;
  if (C.measure == kBitmaskSectors) return mad(-sn, m, Real(16.0f));
  return mad(sn * -1.57079633f, m, Real(16.0f));
}

// Returns the distance of step t, in [0, 1), as a fraction of the radius.
FN Real step_length(Real t) {
  if (C.distribution == kBitmaskStep15) return t * sqrt(t);
  if (C.distribution == kBitmaskStep2) return t * t;
  if (C.distribution == kBitmaskStep3) return t * t * t;
  return t;
}

// Returns the pixel size of the mip level for a tap at a distance in pixels: a tenth of the distance, rounded
// down to a power of two.
FN Real mip_size(Real distance_px) {
  // 0.8122524 is 2^-0.3, so that power = 2^(floor(log2(distance) - 3.3) + 3).
  Uint power = bits_of(distance_px * 0.8122524f) & Uint(0x7f800000u);
  return clamp(real_of_bits(power) * 0.125f, Real(1.0f), Real(float(1 << C.mip_levels)));
}

// Reads the depth at `distance_px` steps of `side` from the pixel. `size`: pixel size of the mip level, 1 for the
// picture itself.
FN Tap tap_at(Origin from, Side side, Real distance_px, Real size, bool near_border) {
  Real x = mad(side.x, distance_px, from.x + 0.5f);
  Real y = mad(side.y, distance_px, from.y + 0.5f);
  Bool inside = from.depth > 0.0f;
  if (C.mip_levels == 0) {
    Real column = floor(x);
    Real row = floor(y);
    if (near_border) {
      x = clamp(column, Real(0.0f), Real(float(F.width - 1)));
      y = clamp(row, Real(0.0f), Real(float(F.height - 1)));
      inside = x == column && y == row;
      column = x;
      row = y;
    }
    return Tap(column, row, read_depth(place_of(column, row)), inside);
  }
  if (near_border) inside = x >= 0.0f && x < float(F.width) && y >= 0.0f && y < float(F.height);
  Real scale = Real(1.0f) / size;
  Real column = floor(x * scale);
  Real row = floor(y * scale);
  // Where the picture's size is not a multiple of the level's pixel size, the level does not cover the last pixels.
  column = clamp(column, Real(0.0f), floor(scale * float(F.width)) - 1.0f);
  row = clamp(row, Real(0.0f), floor(scale * float(F.height)) - 1.0f);
  Bool small = size == 1.0f;
  Real depth = from.depth;
  if (some(small)) depth = read_depth(place_of(column, row));
  if (some(!small)) {
    Real first_row = mad(scale, Real(float(-4 * C.mip_rows)), Real(float(2 * C.mip_rows)));
    Real mip_depth = read_bitmask_mips(place_of(column, row + max(first_row, Real(0.0f))));
    depth = select(small, depth, mip_depth);
  }
  return Tap(mad(column + 0.5f, size, Real(-0.5f)), mad(row + 0.5f, size, Real(-0.5f)), depth, inside);
}

// Returns the vector to the surface at pixel (x, y), made of its true height above the tangent plane and its distance
// along the slice.
FN TapVector vector_to_tap(Origin from, Side side, Real x, Real y, Real depth) {
  Real dx = x - from.x;
  Real dy = y - from.y;
  Real spread = F.orthographic != 0 ? Real(1.0f) : depth;
  Real height = mad(mad(from.height_x, dx, from.height_y * dy), spread, (depth - from.depth) * from.height);
  height = height - from.depth * kDepthRounding;
  Real across = mad(side.along_x, dx, side.along_y * dy) * spread * side.across;
  Real to_eye = mad(across, side.tangent, height * from.one_over_nv);
  Real across2 = max(across * across, Real(1e-30f));
  return TapVector(to_eye, across2, mad(to_eye, to_eye, across2));
}

// Returns the cosine of the angle between the vector and the view direction.
FN Real cosine_of(TapVector to_tap) { return to_tap.to_eye * rsqrt(to_tap.squared); }

// Returns the bits that an occluder covers. Its thickness is the assumed one, but at most `max_thickness`.
FN Uint covered_bits(TapVector to_tap, Side side, Real max_thickness) {
  Real inverse_length = rsqrt(to_tap.squared);
  Real front = max(to_tap.to_eye * inverse_length, side.low);
  Real back = side.low;
  if (C.infinite == 0) {
    Real thickness = max(to_tap.squared * inverse_length * Real(C.slope), Real(C.thickness));
    if (kLayers) thickness = min(thickness, max_thickness);
    Real to_eye = to_tap.to_eye - thickness;
    back = max(to_eye * rsqrt(mad(to_eye, to_eye, to_tap.across2)), side.low);
  }
  Uint from = ones_from(to_int(bit_of(front, side)));
  return from ^ ones_from(to_int(bit_of(back, side)));
}

// Returns the normal; turned towards the camera if it faces away, as interpolated normals may at silhouettes. `eye`:
// the unit vector towards the camera.
FN Vec3 facing_normal(Vec3 normal, Vec3 eye) {
  Real facing = dot(normal, eye);
  if (!some(facing < 0.0f)) return normal;
  Vec3 turned = normal + eye * (kMinFacing - facing);
  return select(facing < 0.0f, turned * rsqrt(max(dot(turned, turned), Real(1e-30f))), normal);
}

// Returns the radius in columns at a depth.
FN Real radius_px_at(Real depth) {
  Real spread = F.orthographic != 0 ? Real(1.0f) : depth;
  return clamp(Real(C.radius_px) / spread, Real(0.0f), Real(kMaxRadiusPx));
}

// Returns whether taps may fall outside the picture. `radius_px`: columns.
FN Bool is_near_border(Origin from, Real radius_px) {
  Real border_columns = radius_px + (kFirstStep + 1.0f);
  Real border_rows = mad(border_columns, Real(-C.rows_per_column), Real(1.0f));
  return from.x < border_columns || from.x > float(F.width - 1) - border_columns || from.y < border_rows ||
         from.y > float(F.height - 1) - border_rows;
}

// Returns the direction of the first slice, rotated by the fraction `turn` of the angle between two slices.
FN Vec2 direction_of(Real turn) {
  // Double-angle formulas yield the cosine and sine of the angle pi turn / slices - pi / 2.
  Real s = sine_of_quarter_turns(mad(turn, Real(C.one_over_slices), Real(-0.5f)));
  Real c = sqrt(mad(-s, s, Real(1.0f)));
  return Vec2(mad(s * s, Real(-2.0f), Real(1.0f)), 2.0f * s * c);
}

// Returns whether a tap shows a surface within the radius.
FN Bool is_near(TapVector to_tap, Real depth) { return to_tap.squared <= Real(C.radius2) && depth > 0.0f; }

FN Origin origin_of(Int px, Int py, Real depth, Vec3 normal, Real facing) {
  Real x = to_real(px);
  Real y = to_real(py);
  Real height = -normal.z;
  if (F.orthographic == 0) {
    height = mad(normal.x, mad(x + 0.5f, Real(F.ray_scale_x), Real(F.ray_offset_x)),
                 mad(normal.y, mad(y + 0.5f, Real(F.ray_scale_y), Real(F.ray_offset_y)), -normal.z));
  }
  return Origin(x, y, depth, height, normal.x * Real(F.ray_scale_x), normal.y * Real(F.ray_scale_y), 1.0f / facing);
}

// Data of the shaded pixel that all its slices share.
struct ShadedPoint {
  Vec3 eye, normal;  // unit vectors: towards the camera; the normal, turned towards the camera
  Real facing;       // N.V
  Origin from;
  Real radius_px;    // columns
  bool near_border;  // whether taps may fall outside the picture
};

// Returns the data of a pixel whose surface is at `depth`.
FN ShadedPoint shaded_point_at(Int px, Int py, Real depth) {
  // The direction of the view ray does not depend on the depth; depth 1 avoids overflow and underflow.
  Vec3 view_ray = view_position(px, py, Real(1.0f));
  Vec3 eye = to_eye(view_ray);
  Vec3 normal = facing_normal(unit_normal(near_normal(0, 0), view_ray), eye);
  Real facing = max(dot(normal, eye), Real(kMinFacing));
  Origin from = origin_of(px, py, depth, normal, facing);
  Real radius_px = radius_px_at(depth);
  return ShadedPoint(eye, normal, facing, from, radius_px, some(is_near_border(from, radius_px)));
}

// Data of one slice.
struct Slice {
  Side above, below;  // the side of the higher and that of the lower bits
  Real cn, sn;        // cosine and sine of n, the angle from the view direction to the normal's projection
  Real weight;        // weight of the slice in the sum over slices
  Real first_above;   // first bit of side `above`, as a real number
  Real projected;     // |n_p|, the length of the normal's projection
  Vec3 outwards;      // unit vector towards higher bits, perpendicular to the view ray
};

// Returns the slice in direction (x, y) of the picture, y upwards. `jitter` shifts the borders between bits, in bits.
FN Slice slice_of(Real x, Real y, Vec3 to_eye, Vec3 normal, Real facing, Real jitter) {
  Real lean = mad(x, to_eye.x, y * to_eye.y);
  Real perpendicular2 = max(mad(-lean, lean, Real(1.0f)), Real(1e-6f));
  Real one_over_perpendicular = rsqrt(perpendicular2);
  Real nt = (mad(normal.x, x, normal.y * y) - lean * facing) * one_over_perpendicular;
  Real projected2 = mad(facing, facing, nt * nt);
  Real one_over_projected = rsqrt(projected2);
  Real cn = facing * one_over_projected;
  Real sn = nt * one_over_projected;
  Real whole = mad(cn * cn, cn, sn * arc(sn));
  Real weight = projected2 * one_over_projected * whole;
  Real m = Real(16.0f) / whole;
  Real k1 = -(m * cn);
  Real k2 = -(m * sn);
  Real middle = jitter + 16.0f;
  if (C.measure == kBitmaskUniform) {
    weight = Real(1.0f);
    m = Real(10.1859164f);  // 32 / pi
    middle = middle - (Real(1.57079633f) - angle_of_cosine(sn)) * m;
  }
  if (C.measure == kBitmaskSectors) {
    weight = projected2 * one_over_projected;
    m = Real(16.0f);
    k1 = m * cn;
    k2 = -(m * sn);
  }
  Real k0_above = middle - k1;
  Real k0_below = middle + k1;
  Real k2_above = k2;
  Real k2_below = k2;
  if (C.measure != kBitmaskExact) {
    k0_above = middle;
    k0_below = middle;
  }
  if (C.measure == kBitmaskUniform) {
    k2_above = m;
    k2_below = -m;
  }
  Real across = perpendicular2 * one_over_perpendicular * Real(F.ray_scale_x);
  Real tangent = nt / facing;
  Real step_y = y * Real(C.rows_per_column);
  Real along_y = y * Real(C.columns_per_row);
  return Slice(Side(x, step_y, x, along_y, across, -tangent, k0_above, k1, k2_above, -sn),
               Side(-x, -step_y, -x, -along_y, across, tangent, k0_below, -k1, k2_below, sn), cn, sn, weight,
               bits_of_negative_side(sn, m), projected2 * one_over_projected,
               (Vec3(x, y, Real(0.0f)) - to_eye * lean) * one_over_perpendicular);
}

// The contribution of one tap: the bits that it covers; the light of those that no earlier tap covers; 1 if the tap is
// inside the picture, or else 0.
struct TapResult {
  Uint bits;
  Vec3 light;
  Real inside;
};

// Returns the light that the surface of layer i at a tap emits, times the number of bits in `new_bits`. `position`:
// that of the shaded point.
FN Vec3 light_of(int i, Uint new_bits, Origin from, Tap tap, Real depth, Vec3 position) {
  Vec3 none = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  Real count = to_real(popcount(new_bits));
  Bool has_new_bits = count > 0.0f;
  if (!some(has_new_bits)) return none;
  Int place = place_of(select(has_new_bits, floor(tap.x), from.x), select(has_new_bits, floor(tap.y), from.y));
  Real spread = F.orthographic != 0 ? Real(1.0f) : depth;
  Vec3 occluder = Vec3(mad(tap.x + 0.5f, Real(F.ray_scale_x), Real(F.ray_offset_x)) * spread,
                       mad(tap.y + 0.5f, Real(F.ray_scale_y), Real(F.ray_offset_y)) * spread, -depth);
  // If the shaded point faces the back side of the surface, the light is that of the back side.
  Vec3 to_tap = occluder - position;
  Real turned = dot(to_tap, normal_of(C.layer[i], place));
  Bool shows_back = turned * abs(turned) > dot(to_tap, to_tap) * kEdgeOn;
  Vec3 light = select(has_new_bits && !shows_back, outgoing_light_of(C.layer[i], place), none);
  if (C.back[i] >= 0 && some(has_new_bits && shows_back))
    light = select(has_new_bits && shows_back, outgoing_light_of(C.back[i], place), light);
  return light * count;
}

// Evaluates one tap. `covered`: bits that earlier taps have covered.
FN TapResult evaluate_tap(Origin from, Side side, Real distance_px, Real size, bool near_border, Uint covered,
                          Vec3 position) {
  Vec3 light = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  Tap tap = tap_at(from, side, distance_px, size, near_border);
  Uint bits = Uint(0u);
  Real depth = tap.depth;
  int count = kLayers ? C.layer_count : 1;
  for (int i = 0; i < count; ++i) {
    TapVector to_tap = vector_to_tap(from, side, tap.x, tap.y, depth);
    Bool counts = is_near(to_tap, depth) && tap.inside;
    Real next = depth;
    Real max_thickness = Real(3e38f);
    if (kLayers && i + 1 < count) {
      next = read_depth_of(C.layer[i + 1], place_of(tap.x, tap.y));
      // The occluder ends where the next surface begins, at the latest.
      max_thickness = select(next > depth, next - depth, max_thickness);
    }
    Uint new_bits = select(counts, covered_bits(to_tap, side, max_thickness), Uint(0u));
    if (kLight) light = light + light_of(i, new_bits & ~(covered | bits), from, tap, depth, position);
    bits = bits | new_bits;
    depth = next;
  }
  return TapResult(bits, light, select(tap.inside, Real(1.0f), Real(0.0f)));
}

// Returns the weighted sum of the unoccluded directions of a slice, sampled at the centres of 32 equal angles. `bits`:
// the covered ones. x of the result is along the slice, y towards the camera.
FN Vec2 unoccluded_directions(Slice slice, Uint bits) {
  // Cosine and sine of half a step and of a whole step of pi / 32.
  float half_cos = 0.99879546f;
  float half_sin = 0.04906767f;
  float step_cos = 0.99518473f;
  float step_sin = 0.09801714f;
  Real c = mad(slice.sn, Real(half_cos), slice.cn * half_sin);
  Real s = mad(slice.sn, Real(half_sin), slice.cn * -half_cos);
  // `height` and `width` are the sine and cosine of the angle to the tangent plane.
  float height = half_sin;
  float width = half_cos;
  Vec2 sum = Vec2(Real(0.0f), Real(0.0f));
  for (int i = 0; i < 32; ++i) {
    Real above = bit_of(max(c, slice.above.low), slice.above);
    Real below = bit_of(max(c, slice.below.low), slice.below);
    Int bit = clamp(to_int(select(s < 0.0f, below, above)), Int(0), Int(31));
    Bool open = popcount(bits & (ones_from(bit) ^ ones_from(bit + Int(1)))) == Int(0);
    Real weight = select(open, abs(s) * height, Real(0.0f));
    sum = Vec2(mad(s, weight, sum.x), mad(c, weight, sum.y));
    Real turned = mad(c, Real(step_cos), s * -step_sin);
    s = mad(s, Real(step_cos), c * step_sin);
    c = turned;
    float higher = height * step_cos + width * step_sin;
    width = width * step_cos - height * step_sin;
    height = higher;
  }
  return sum;
}

// Computes one pixel: searches all slices, and stores `ao` and, if requested, the light and the mean unoccluded
// direction.
FN void gather(Int px, Int py) {
  Vec3 none = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  Bool surface = is_surface(near_depth(0, 0));
  if (!some(surface)) {
    store_ao(Real(1.0f));
    if (kLight) store_light(none);
    if (kBent) store_bent_normal(none);
    return;
  }
  Real depth = select(surface, near_depth(0, 0), Real(1.0f));
  Vec3 position = view_position(px, py, depth);
  ShadedPoint point = shaded_point_at(px, py, depth);
  Vec3 noise = noise_at(px, py);
  Vec2 direction = direction_of(noise.x);
  Real open_sum = Real(0.0f);
  Real weight_sum = Real(0.0f);
  Vec3 light = none;
  SkyLight sky = SkyLight(none, none);
  Vec3 bent = none;
  for (int s = 0; s < C.slices; ++s) {
    Real bit_jitter = fract(mad(Real(float(s)), Real(kStepTurn), noise.z));
    bit_jitter = mad(bit_jitter, Real(kBitJitter), Real(0.5f - 0.5f * kBitJitter));
    Slice slice = slice_of(direction.x, direction.y, point.eye, point.normal, point.facing, bit_jitter);
    Real jitter = fract(mad(Real(float(s)), Real(kStepTurn), noise.y));
    Uint bits = Uint(0u);
    Real inside_above = Real(0.0f);
    Real inside_below = Real(0.0f);
    Vec3 light_above = none;
    Vec3 light_below = none;
    for (int k = 0; k < C.steps; ++k) {
      Real distance_px =
          mad(step_length((jitter + float(k)) * Real(C.one_over_steps)), point.radius_px, Real(kFirstStep));
      Real size = mip_size(distance_px);
      TapResult above = evaluate_tap(point.from, slice.above, distance_px, size, point.near_border, bits, position);
      bits = bits | above.bits;
      TapResult below = evaluate_tap(point.from, slice.below, distance_px, size, point.near_border, bits, position);
      bits = bits | below.bits;
      if (kLight) {
        light_above = light_above + above.light;
        light_below = light_below + below.light;
      }
      if (point.near_border) {
        inside_above = inside_above + above.inside;
        inside_below = inside_below + below.inside;
      }
    }
    Real covered = to_real(popcount(bits));
    Real open = mad(covered, Real(-0.03125f), Real(1.0f)) * slice.weight;
    Real whole = slice.weight;
    light_above = light_above * slice.weight;
    light_below = light_below * slice.weight;
    if (point.near_border && C.skip_outside != 0) {
      // A side is weighted by the fraction of its taps that are inside the picture.
      Real fraction_above = inside_above * Real(C.one_over_steps);
      Real fraction_below = inside_below * Real(C.one_over_steps);
      Real low = floor(slice.first_above + 0.5f);
      Real covered_above = to_real(popcount(bits & ones_from(to_int(low))));
      Real whole_above = (32.0f - low) * fraction_above * slice.weight * 0.03125f;
      Real whole_below = low * fraction_below * slice.weight * 0.03125f;
      whole = whole_above + whole_below;
      if (kLight && C.directional != 0.0f) {
        Uint bits_above = ones_from(to_int(low));
        sky = with_sky_light(sky, bits_above, bits, fraction_above * slice.weight, slice.sn, point.eye, slice.outwards);
        sky =
            with_sky_light(sky, ~bits_above, bits, fraction_below * slice.weight, slice.sn, point.eye, slice.outwards);
      }
      open = mad(whole_above, 1.0f - covered_above / max(32.0f - low, Real(1.0f)),
                 whole_below * (1.0f - (covered - covered_above) / max(low, Real(1.0f))));
      // On a surface seen edge-on, one side has no bits of its own. It gets no light: where the other side is outside
      // the picture, the result would be rounding errors alone.
      light_above = light_above * select(low < 32.0f, fraction_above, Real(0.0f));
      light_below = light_below * select(low > 0.0f, fraction_below, Real(0.0f));
    } else if (kLight && C.directional != 0.0f) {
      sky = with_sky_light(sky, ~Uint(0u), bits, slice.weight, slice.sn, point.eye, slice.outwards);
    }
    open_sum = open_sum + open;
    weight_sum = weight_sum + whole;
    if (kLight) light = light + (light_above + light_below);
    if (kBent) {
      Vec2 sum = unoccluded_directions(slice, bits);
      bent = bent + (slice.outwards * sum.x + point.eye * sum.y) * slice.projected;
    }
    direction = Vec2(mad(direction.x, Real(C.turn_cos), direction.y * -C.turn_sin),
                     mad(direction.y, Real(C.turn_cos), direction.x * C.turn_sin));
  }
  Real divisor = max(weight_sum, Real(1e-6f));
  Real ao = select(surface && weight_sum > 1e-6f, min(open_sum / divisor, Real(1.0f)), Real(1.0f));
  store_ao(ao);
  if (kLight) {
    light = light * Real(C.bleeding) + (sky.open - sky.all * ao) * Real(C.directional);
    light = light * (Real(0.03125f) / divisor);
    light = Vec3(min(light.x, Real(kMaxLight)), min(light.y, Real(kMaxLight)), min(light.z, Real(kMaxLight)));
    store_light(select(surface, finite_or_zero(light), none));
  }
  if (kBent) store_bent_normal(select(surface, select(dot(bent, bent) > 1e-12f, normalized(bent), point.normal), none));
}
