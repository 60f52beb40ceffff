// Occlusion by slices of the hemisphere. Along each slice, taps read depths outwards on both sides; surfaces that rise
// above the tangent plane cover an interval of directions. Based on the visibility bitmask of [Therrien et al. 2023],
// with bits of equal cosine weight (bitmask_measure.kernel.h).
//
// Several kernels include this text. Before that, they define:
//   kLayers                 whether occluders are searched in all depth layers, or only in the first
//   kLight                  whether occluders contribute indirect light
//   kBent                   whether the mean unoccluded direction is stored
//   depth_of                returns the depth of a layer behind the first
//   normal_of, outgoing_light_of      return the normal and the outgoing light of a pixel of a layer
//   store_light, store_bent
// Files such as bitmask_one_layer.kernel.h hold definitions that several kernels share.
//
// A tap reads one pixel, whose centre is not in the slice. The tap uses the true height of that pixel above the tangent
// plane and its distance along the slice, so that a plane does not occlude itself at any tilt.
//
// Which pixel a tap reads depends only on operations that round identically on every machine: no rsqrt there.
IN_VECTOR(normal)
IN_REAL(bitmask_mips)
OUT_REAL(ao)

#include "effects/bitmask/bitmask_measure.kernel.h"
#include "effects/bitmask/bitmask_noise.kernel.h"

CONST float kDepthRounding = 2e-6f;   // relative to the depth: 16 to 32 units in the last place
CONST float kFirstStep = 1.3f;        // pixels; nearer taps would read the pixel itself
CONST float kMaxReach = 1e5f;         // pixels
CONST float kMinFacing = 0.1f;        // min N.V; smaller values are clamped
CONST float kStepTurn = 0.61803399f;  // offset of the jitter of steps and bits from slice to slice
CONST float kEdgeOn = 2.5e-7f;   // squared cosine, error of packed normals; surfaces seen edge-on count as front sides
CONST float kBitJitter = 0.98f;  // range of the jitter of bit borders, in bits
CONST float kMaxLight = 1e18f;   // bound of the gathered light, so that it stays finite

// The pixel that is shaded, shared by all its taps.
struct Origin {
  Real x, y, depth;
  Real height;              // height change per unit of depth along the view ray: N . ray
  Real height_x, height_y;  // height change per pixel to the right and down, at depth 1
  Real one_over_nv;
};

// One side of a slice: the bit of a direction with cosine c is k0 + k1 f(c) + k2 g(c).
struct Side {
  Real x, y;              // length of one step towards this side, in columns and rows
  Real along_x, along_y;  // steps per pixel to the right and down
  Real across;            // length of one step at depth 1, perpendicular to the view ray
  Real tangent;           // slope of the tangent plane along this side, towards the camera
  Real k0, k1, k2;
  Real low;  // cosine between view direction and tangent plane: min of all cosines on this side
};

// One tap: position of the pixel that was read (its centre minus 0.5), its depth, and whether it is inside the picture.
struct Tap {
  Real x, y, depth;
  Bool inside;
};

// A vector from the shaded pixel to a tap: component towards the camera; squared perpendicular component; squared
// length, > 0.
struct Way {
  Real to_eye, across2, squared;
};

// Returns the bit, with fraction, of the direction with cosine c to the view direction.
FN Real bit_of(Real c, Side side) {
  if (C.measure == kBitmaskUniform) return mad(angle_of_cosine(c), side.k2, side.k0);
  if (C.measure == kBitmaskSectors)
    return mad(sqrt(max(mad(-c, c, Real(1.0f)), Real(0.0f))), side.k1, mad(c, side.k2, side.k0));
  return mad(c * c, side.k1, mad(arc(c), side.k2, side.k0));
}

// Returns how many of the slice's 32 bits, with fraction, lie on the side of negative angles.
FN Real bits_of_negative_side(Real sn, Real m) {
  if (C.measure == kBitmaskUniform) return Real(16.0f) - (Real(1.57079633f) - angle_of_cosine(sn)) * m;
  if (C.measure == kBitmaskSectors) return mad(-sn, m, Real(16.0f));
  return mad(sn * -1.57079633f, m, Real(16.0f));
}

// Maps the position t of a step, in [0, 1), to its distance as a fraction of the radius.
FN Real step_length(Real t) {
  if (C.distribution == kBitmaskStep15) return t * sqrt(t);
  if (C.distribution == kBitmaskStep2) return t * t;
  if (C.distribution == kBitmaskStep3) return t * t * t;
  return t;
}

// Returns the pixel size of the mip level for a tap at distance `off` in pixels: about a tenth of the distance.
FN Real mip_size(Real off) {
  Uint power = bits_of(off * 0.8122524f) & Uint(0x7f800000u);  // 2^-0.3; power = 2^(floor(log2(off) - 3.3) + 3)
  return clamp(real_of_bits(power) * 0.125f, Real(1.0f), Real(float(1 << C.mip_levels)));
}

// Reads the pixel `off` steps away. `size`: pixel size of the mip level, 1 for the picture itself.
FN Tap tap_at(Origin from, Side side, Real off, Real size, bool near_border) {
  Real x = mad(side.x, off, from.x + 0.5f);
  Real y = mad(side.y, off, from.y + 0.5f);
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
  // A level lacks its last column or row where the picture's size is not a multiple of its pixel size.
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

// Returns the vector to the surface at a tap, with its true height above the tangent plane and its distance in the
// slice.
FN Way vector_to_tap(Origin from, Side side, Real x, Real y, Real depth) {
  Real dx = x - from.x;
  Real dy = y - from.y;
  Real spread = F.orthographic != 0 ? Real(1.0f) : depth;
  Real height = mad(mad(from.height_x, dx, from.height_y * dy), spread, (depth - from.depth) * from.height);
  height = height - from.depth * kDepthRounding;
  Real across = mad(side.along_x, dx, side.along_y * dy) * spread * side.across;
  Real to_eye = mad(across, side.tangent, height * from.one_over_nv);
  Real across2 = max(across * across, Real(1e-30f));
  return Way(to_eye, across2, mad(to_eye, to_eye, across2));
}

// Returns the cosine of the angle between the vector and the view direction.
FN Real cosine_of(Way way) { return way.to_eye * rsqrt(way.squared); }

// Returns the bits that an occluder covers, with the assumed thickness but at most `most`.
FN Uint covered_bits(Way way, Side side, Real max_value) {
  Real one_over = rsqrt(way.squared);
  Real front = max(way.to_eye * one_over, side.low);
  Real back = side.low;
  if (C.infinite == 0) {
    Real thick = max(way.squared * one_over * Real(C.slope), Real(C.thickness));
    if (kLayers) thick = min(thick, max_value);
    Real to_eye = way.to_eye - thick;
    back = max(to_eye * rsqrt(mad(to_eye, to_eye, way.across2)), side.low);
  }
  Uint from = ones_from(to_int(bit_of(front, side)));
  return from ^ ones_from(to_int(bit_of(back, side)));
}

// Returns the normal; turned towards the camera if it faces away, as interpolated normals do at silhouettes.
FN Vec3 facing_normal(Vec3 normal, Vec3 eye) {
  Real facing = dot(normal, eye);
  if (!some(facing < 0.0f)) return normal;
  Vec3 turned = normal + eye * (kMinFacing - facing);
  return select(facing < 0.0f, turned * rsqrt(max(dot(turned, turned), Real(1e-30f))), normal);
}

// Returns the radius in columns at this depth.
FN Real reach_of(Real depth) {
  Real spread = F.orthographic != 0 ? Real(1.0f) : depth;
  return clamp(Real(C.reach) / spread, Real(0.0f), Real(kMaxReach));
}

// Returns whether taps may fall outside the picture.
FN Bool is_near_border(Origin from, Real reach) {
  Real wide = reach + (kFirstStep + 1.0f);
  Real high = mad(wide, Real(-C.step_y), Real(1.0f));
  return from.x < wide || from.x > float(F.width - 1) - wide || from.y < high || from.y > float(F.height - 1) - high;
}

// Returns the direction of the first slice, rotated by the fraction `turn` of the angle between two slices.
FN Vec2 direction_of(Real turn) {
  // The angle is pi turn / slices - pi / 2, by the double-angle formulas.
  Real s = sine_of_quarter_turns(mad(turn, Real(C.one_over_slices), Real(-0.5f)));
  Real c = sqrt(mad(-s, s, Real(1.0f)));
  return Vec2(mad(s * s, Real(-2.0f), Real(1.0f)), 2.0f * s * c);
}

// Returns whether a tap shows a surface within the radius.
FN Bool is_near(Way way, Real depth) { return way.squared <= Real(C.radius2) && depth > 0.0f; }

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

// Data shared by all slices of a pixel.
struct Seen {
  Vec3 eye, normal;  // unit vectors; towards the camera, and the normal facing it
  Real facing;       // N.V
  Origin from;
  Real reach;        // columns
  bool near_border;  // whether taps may fall outside the picture
};

FN Seen shaded_point_at(Int px, Int py, Real depth) {
  // The direction does not depend on the depth; depth 1 avoids overflow and underflow.
  Vec3 sight = view_position(px, py, Real(1.0f));
  Vec3 eye = to_eye(sight);
  Vec3 normal = facing_normal(unit_normal(near_normal(0, 0), sight), eye);
  Real facing = max(dot(normal, eye), Real(kMinFacing));
  Origin from = origin_of(px, py, depth, normal, facing);
  Real reach = reach_of(depth);
  return Seen(eye, normal, facing, from, reach, some(is_near_border(from, reach)));
}

// Data of one slice.
struct Slice {
  Side above, below;  // the sides of higher and lower bits
  Real cn, sn;        // cosine and sine of n, the angle of the normal's projection
  Real weight;        // how much the slice counts in the sum over slices
  Real first_above;   // the bit, with fraction, at which side `above` begins
  Real projected;     // |n_p|
  Vec3 outwards;      // unit vector towards higher bits, perpendicular to the view ray
};

// Returns the slice in direction (x, y) of the picture, y upwards. `jitter` moves the borders between bits.
FN Slice slice_of(Real x, Real y, Vec3 to_eye, Vec3 normal, Real facing, Real jitter) {
  Real lean = mad(x, to_eye.x, y * to_eye.y);
  Real t2 = max(mad(-lean, lean, Real(1.0f)), Real(1e-6f));
  Real one_over_t = rsqrt(t2);
  Real nt = (mad(normal.x, x, normal.y * y) - lean * facing) * one_over_t;
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
  Real across = t2 * one_over_t * Real(F.ray_scale_x);
  Real tangent = nt / facing;
  Real down_y = y * Real(C.step_y);
  Real along_y = y * Real(C.along_y);
  return Slice(Side(x, down_y, x, along_y, across, -tangent, k0_above, k1, k2_above, -sn),
               Side(-x, -down_y, -x, -along_y, across, tangent, k0_below, -k1, k2_below, sn), cn, sn, weight,
               bits_of_negative_side(sn, m), projected2 * one_over_projected,
               (Vec3(x, y, Real(0.0f)) - to_eye * lean) * one_over_t);
}

// The contribution of one tap: covered bits, light of the newly covered ones, 1 if it is inside the picture.
struct Found {
  Uint bits;
  Vec3 light;
  Real inside;
};

// Returns the light from layer i at a tap, times the number of bits in `fresh`.
FN Vec3 light_of(int i, Uint fresh, Origin from, Tap tap, Real depth, Vec3 position) {
  Vec3 none = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  Real count = to_real(popcount(fresh));
  Bool sends = count > 0.0f;
  if (!some(sends)) return none;
  Int place = place_of(select(sends, floor(tap.x), from.x), select(sends, floor(tap.y), from.y));
  Real spread = F.orthographic != 0 ? Real(1.0f) : depth;
  Vec3 there = Vec3(mad(tap.x + 0.5f, Real(F.ray_scale_x), Real(F.ray_offset_x)) * spread,
                    mad(tap.y + 0.5f, Real(F.ray_scale_y), Real(F.ray_offset_y)) * spread, -depth);
  // Light of the back side, if the shaded pixel faces that.
  Vec3 way = there - position;
  Real turned = dot(way, normal_of(C.layer[i], place));
  Bool away = turned * abs(turned) > dot(way, way) * kEdgeOn;
  Vec3 light = select(sends && !away, outgoing_light_of(C.layer[i], place), none);
  if (C.back[i] >= 0 && some(sends && away)) light = select(sends && away, outgoing_light_of(C.back[i], place), light);
  return light * count;
}

// Reads one tap. `covered`: bits that earlier taps have covered.
FN Found read_tap(Origin from, Side side, Real off, Real size, bool near_border, Uint covered, Vec3 position) {
  Vec3 light = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  Tap tap = tap_at(from, side, off, size, near_border);
  Uint bits = Uint(0u);
  Real depth = tap.depth;
  int count = kLayers ? C.layer_count : 1;
  for (int i = 0; i < count; ++i) {
    Way way = vector_to_tap(from, side, tap.x, tap.y, depth);
    Bool counts = is_near(way, depth) && tap.inside;
    Real next = depth;
    Real max_value = Real(3e38f);
    if (kLayers && i + 1 < count) {
      next = depth_of(C.layer[i + 1], place_of(tap.x, tap.y));
      // The occluder ends where the next surface begins, at the latest.
      max_value = select(next > depth, next - depth, max_value);
    }
    Uint fresh = select(counts, covered_bits(way, side, max_value), Uint(0u));
    if (kLight) light = light + light_of(i, fresh & ~(covered | bits), from, tap, depth, position);
    bits = bits | fresh;
    depth = next;
  }
  return Found(bits, light, select(tap.inside, Real(1.0f), Real(0.0f)));
}

// Returns the weighted sum of the unoccluded directions of a slice, sampled at the centres of 32 equal angles: x along
// the slice, y towards the camera.
FN Vec2 unoccluded_directions(Slice slice, Uint bits) {
  // Half a step, and a whole step, of pi / 32.
  float half_cos = 0.99879546f;
  float half_sin = 0.04906767f;
  float step_cos = 0.99518473f;
  float step_sin = 0.09801714f;
  Real c = mad(slice.sn, Real(half_cos), slice.cn * half_sin);
  Real s = mad(slice.sn, Real(half_sin), slice.cn * -half_cos);
  // Sine and cosine of the angle to the tangent plane.
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

// Computes one pixel: searches all slices, and stores `ao` and, if requested, light and the bent normal.
FN void gather(Int px, Int py) {
  Vec3 none = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  Bool surface = is_surface(near_depth(0, 0));
  if (!some(surface)) {
    store_ao(Real(1.0f));
    if (kLight) store_light(none);
    if (kBent) store_bent(none);
    return;
  }
  Real depth = select(surface, near_depth(0, 0), Real(1.0f));
  Vec3 position = view_position(px, py, depth);
  Seen seen = shaded_point_at(px, py, depth);
  Vec3 noise = noise_at(px, py);
  Vec2 direction = direction_of(noise.x);
  Real open_sum = Real(0.0f);
  Real whole_sum = Real(0.0f);
  Vec3 light = none;
  Vec3 bent = none;
  for (int s = 0; s < C.slices; ++s) {
    Real bit_jitter = fract(mad(Real(float(s)), Real(kStepTurn), noise.z));
    bit_jitter = mad(bit_jitter, Real(kBitJitter), Real(0.5f - 0.5f * kBitJitter));
    Slice slice = slice_of(direction.x, direction.y, seen.eye, seen.normal, seen.facing, bit_jitter);
    Real jitter = fract(mad(Real(float(s)), Real(kStepTurn), noise.y));
    Uint bits = Uint(0u);
    Real inside_above = Real(0.0f);
    Real inside_below = Real(0.0f);
    Vec3 light_above = none;
    Vec3 light_below = none;
    for (int k = 0; k < C.steps; ++k) {
      Real off = mad(step_length((jitter + float(k)) * Real(C.one_over_steps)), seen.reach, Real(kFirstStep));
      Real size = mip_size(off);
      Found above = read_tap(seen.from, slice.above, off, size, seen.near_border, bits, position);
      bits = bits | above.bits;
      Found below = read_tap(seen.from, slice.below, off, size, seen.near_border, bits, position);
      bits = bits | below.bits;
      if (kLight) {
        light_above = light_above + above.light;
        light_below = light_below + below.light;
      }
      if (seen.near_border) {
        inside_above = inside_above + above.inside;
        inside_below = inside_below + below.inside;
      }
    }
    Real covered = to_real(popcount(bits));
    Real open = mad(covered, Real(-0.03125f), Real(1.0f)) * slice.weight;
    Real whole = slice.weight;
    light_above = light_above * slice.weight;
    light_below = light_below * slice.weight;
    if (seen.near_border && C.skip_outside != 0) {
      // A side is weighted by the fraction of its taps that are inside the picture.
      Real share_above = inside_above * Real(C.one_over_steps);
      Real share_below = inside_below * Real(C.one_over_steps);
      Real low = floor(slice.first_above + 0.5f);
      Real covered_above = to_real(popcount(bits & ones_from(to_int(low))));
      Real whole_above = (32.0f - low) * share_above * slice.weight * 0.03125f;
      Real whole_below = low * share_below * slice.weight * 0.03125f;
      whole = whole_above + whole_below;
      open = mad(whole_above, 1.0f - covered_above / max(32.0f - low, Real(1.0f)),
                 whole_below * (1.0f - (covered - covered_above) / max(low, Real(1.0f))));
      // A side without bits of its own, of a surface seen edge-on, gets no light: rounding errors would be its only
      // light where the other side is outside the picture.
      light_above = light_above * select(low < 32.0f, share_above, Real(0.0f));
      light_below = light_below * select(low > 0.0f, share_below, Real(0.0f));
    }
    open_sum = open_sum + open;
    whole_sum = whole_sum + whole;
    if (kLight) light = light + (light_above + light_below);
    if (kBent) {
      Vec2 sum = unoccluded_directions(slice, bits);
      bent = bent + (slice.outwards * sum.x + seen.eye * sum.y) * slice.projected;
    }
    direction = Vec2(mad(direction.x, Real(C.turn_cos), direction.y * -C.turn_sin),
                     mad(direction.y, Real(C.turn_cos), direction.x * C.turn_sin));
  }
  Real known = max(whole_sum, Real(1e-6f));
  store_ao(select(surface && whole_sum > 1e-6f, min(open_sum / known, Real(1.0f)), Real(1.0f)));
  if (kLight) {
    light = light * (Real(C.bleeding * 0.03125f) / known);
    light = Vec3(min(light.x, Real(kMaxLight)), min(light.y, Real(kMaxLight)), min(light.z, Real(kMaxLight)));
    store_light(select(surface, finite_or_zero(light), none));
  }
  if (kBent) store_bent(select(surface, select(dot(bent, bent) > 1e-12f, normalized(bent), seen.normal), none));
}
