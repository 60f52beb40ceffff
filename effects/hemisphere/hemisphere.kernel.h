// Occlusion and reflected light from sample points in a hemisphere. A sample point above a pixel's surface is occluded
// where the depth buffer has a surface in front of it; that surface, the occluder, reflects its light to the pixel.
// Based on [Colliander and Törnquist 2015], "SSAO Pass" and "Calculating Colour Bleed", equation 1.
//
// Two kernels include this text. Each defines before it: normal_of and outgoing_light_of (the normal of a layer's
// surface and the light that it emits), store_light, and kGathersLight.
//
// Whether a sample counts depends on the pixel into which it falls. Positions are therefore computed only with
// operations that round identically on every machine: no rsqrt before that.
//
// Differs, for `area=measured`: equation 1 is a sum over emitting surface, so the area that each hit (occluded sample)
// represents must be known. A patch dA at Q occludes all samples behind it along the view ray that are still in the
// hemisphere. With N samples of density p, N dA cos(view) int p dt samples hit it on average, so one hit represents
// 1 / (N cos(view) int p dt). A fraction a of our lengths is uniform in the logarithm between r0 and R, the fraction
// 1 - a is uniform between 0 and R:
//   2 pi p = a / (ln(R/r0) r^3) + (1 - a) / (R r^2)
// With b the distance from P to the ray, t the length along the ray from there, r^2 = b^2 + t^2 and tan(phi) = t/b,
//   int dt / r^3 = sin(phi) / b^2,  int dt / r^2 = phi / b
// The light of one hit, divided by pi, is then
//   2/N  L cos(or) cos(oc)/cos(view)  b^2/d^2 / (a [sin(phi)] / ln(R/r0) + (1 - a) [phi] b/R)
// with [] the difference between the ray's end in the hemisphere and Q. Since b^2/d^2 = cos^2(phi at Q), it is bounded
// however near Q is.
CONST float kDepthRounding = 2e-6f;  // relative to the depth: 16 to 32 ulp of a float
// Minimum depth of a sample, relative to the pixel's depth; samples behind the camera move there
CONST float kMinDepth = 1e-3f;
// Minimum difference of sin(phi) between Q and the point where the ray leaves the hemisphere; the range is 2
CONST float kMinSpan = 0.02f;
CONST float kMinCosine = 0.1f;      // minimum cosine of the angle at which the camera sees an emitter
CONST float kMaxHitWeight = 16.0f;  // maximum of what one hit represents, relative to the average: avoids fireflies
CONST float kMaxLight = 1e18f;      // maximum light of a pixel: keeps it finite

#include "effects/hemisphere/hemisphere_basis.kernel.h"

// Returns e^x for x in [-8, 0], with operations that round identically everywhere: the series for x/16, squared four
// times.
FN Real exp_of(Real x) {
  Real y = x * 0.0625f;
  Real sum = mad(y, Real(1.0f / 120.0f), Real(1.0f / 24.0f));
  sum = mad(sum, y, Real(1.0f / 6.0f));
  sum = mad(sum, y, Real(0.5f));
  sum = mad(sum, y, Real(1.0f));
  sum = mad(sum, y, Real(1.0f));
  sum = sum * sum;
  sum = sum * sum;
  sum = sum * sum;
  return sum * sum;
}

// Returns the window depth: the depth buffer's value for the frustum between near and far.
FN Real window_depth(Real depth) {
  Real between = clamp(depth, Real(C.near_depth), Real(C.far_depth));
  return Real(C.window_one) - Real(C.window_inverse) / between;
}

// Returns the maximum difference in depth at which an occluder of a pixel counts.
FN Real range_limit(Real depth) {
  Real limit = Real(C.limit);
  if (C.range == kHemisphereRangeLinear || C.range == kHemisphereRangeQuadratic) {
    Real fall = Real(C.depth_at_limit) / max(depth, Real(1e-30f));
    limit = limit * fall;
    if (C.range == kHemisphereRangeQuadratic) limit = limit * fall;
  }
  return clamp(limit, Real(1e-30f), Real(1e30f));
}

// Returns the weight of an occluder by the difference of its depth and the pixel's.
FN Real range_weight(Real depth, Real tap, Real limit) {
  if (C.range == kHemisphereRangeNone) return Real(1.0f);
  Real difference = abs(depth - tap);
  if (C.window != 0) difference = abs(window_depth(depth) - window_depth(tap));
  if (C.range == kHemisphereRangeSmoothstep) {
    if (!some(difference > limit)) return Real(1.0f);
    Real t = limit / max(difference, limit);  // 1 within the limit
    return t * t * (3.0f - (t + t));
  }
  return select(difference < limit, Real(1.0f), Real(0.0f));
}

// rotated_to_view rotates a vector from the first camera's view space to that of the i-th layer's camera,
// rotated_from_view rotates it back; view_translation is the translation of that transform.
FN Vec3 rotated_to_view(int i, Vec3 v) {
  return Vec3(dot(Vec3(Real(C.move[12 * i]), Real(C.move[12 * i + 1]), Real(C.move[12 * i + 2])), v),
              dot(Vec3(Real(C.move[12 * i + 4]), Real(C.move[12 * i + 5]), Real(C.move[12 * i + 6])), v),
              dot(Vec3(Real(C.move[12 * i + 8]), Real(C.move[12 * i + 9]), Real(C.move[12 * i + 10])), v));
}
FN Vec3 view_translation(int i) {
  return Vec3(Real(C.move[12 * i + 3]), Real(C.move[12 * i + 7]), Real(C.move[12 * i + 11]));
}
FN Vec3 rotated_from_view(int i, Vec3 v) {
  return Vec3(dot(Vec3(Real(C.move[12 * i]), Real(C.move[12 * i + 4]), Real(C.move[12 * i + 8])), v),
              dot(Vec3(Real(C.move[12 * i + 1]), Real(C.move[12 * i + 5]), Real(C.move[12 * i + 9])), v),
              dot(Vec3(Real(C.move[12 * i + 2]), Real(C.move[12 * i + 6]), Real(C.move[12 * i + 10])), v));
}

FN Real depth_in_view(int i, Vec3 position) { return -(rotated_to_view(i, position) + view_translation(i)).z; }

// Antiderivative of the samples' density along a view ray, times b^2: sin(phi), without the part within r0.
FN Real passed(Real sine, Real inner_sine) {
  Real beyond = max(abs(sine) - inner_sine, Real(0.0f));
  return select(sine < 0.0f, -beyond, beyond);
}

// Returns the angle, 0 to pi, of the direction (x, y), y >= 0: exact at multiples of 45 degrees, within 1 % between.
FN Real angle_of(Real x, Real y) {
  Real m = y / max(abs(x) + y, Real(1e-30f));
  Real bow = m * (1.0f - m);
  Real angle = mad(bow * mad(m, Real(2.0f), Real(-1.0f)), mad(bow, Real(0.99f), Real(0.5707963f)), m * 1.5707963f);
  return select(x < 0.0f, Real(3.1415927f) - angle, angle);
}

// Returns what one hit represents: the light that arrives from it, divided by pi, for an emitted light of 1. `way`
// leads from the pixel to the emitter, `facing` is the emitter's normal, `sight` the unit direction in which the camera
// sees the emitter, `widening` the ratio of the sample's depth to the emitter's.
FN Real arriving_share(Vec3 way, Vec3 normal, Vec3 facing, Vec3 sight, Real widening) {
  Real squared = max(dot(way, way), Real(1e-30f));
  Real one_over = rsqrt(squared);
  Real height = dot(way, normal);
  Real cos_receiver = height * one_over;
  Real cos_emitter = -dot(way, facing) * one_over;
  Bool sees = cos_receiver > 0.0f && cos_emitter > 0.0f;
  Real fraction = cos_receiver * min(cos_emitter, Real(1.0f)) * Real(C.area_factor);
  if (C.area == kHemisphereAreaMeasured) {
    Real t = dot(way, sight);
    Real b2 = max(squared - t * t, Real(C.min_b2));
    Real end2 = max(Real(C.radius * C.radius) - b2, Real(0.0f));
    Real end = end2 * rsqrt(max(end2, Real(1e-30f)));
    if (C.above != 0) {
      // There are no samples where the ray is below the surface.
      Real dive = -dot(sight, normal);
      Real below = t + height / max(dive, Real(1e-6f));
      end = select(dive > 1e-6f, min(end, below), end);
    }
    Real inner_share = min(b2 * Real(C.one_over_inner2), Real(1.0f));
    Real inner_sine = sqrt(Real(1.0f) - inner_share);
    Real one_over_near = rsqrt(mad(t, t, b2));
    Real near_sine = passed(t * one_over_near, inner_sine);
    Real end_sine = passed(end * rsqrt(mad(end, end, b2)), inner_sine);
    Real foot = b2 * rsqrt(b2);
    Real seen_angle = angle_of(mad(t, end, b2), max(end - t, Real(0.0f)) * foot);
    Real found = max(end_sine - near_sine, inner_share * kMinSpan) * Real(C.log_share);
    found = mad(seen_angle * foot, Real(C.even_fraction_by_radius), found);
    Real cos_view = max(abs(dot(sight, facing)), Real(kMinCosine));
    // View rays diverge: with distance there are more samples between them.
    fraction = fraction * (b2 * one_over_near * one_over_near) / (cos_view * found * (widening * widening));
    fraction = min(fraction, Real(C.area_factor * kMaxHitWeight));
    sees = sees && squared <= Real(C.radius * C.radius);
  } else {
    fraction = fraction / max(squared, Real(C.min_distance * C.min_distance));
  }
  return select(sees, fraction, Real(0.0f));
}

// Returns the position at the centre of pixel (x, y) of the i-th layer, in the space of that layer's camera. x and y
// are integers.
FN Vec3 position_in_view(int i, Real x, Real y, Real depth) {
  Real spread = C.orthographic[i] != 0 ? Real(1.0f) : depth;
  return Vec3(mad(x + 0.5f, Real(C.ray_scale_x[i]), Real(C.ray_offset_x[i])) * spread,
              mad(y + 0.5f, Real(C.ray_scale_y[i]), Real(C.ray_offset_y[i])) * spread, -depth);
}

// Returns a s + b.
FN Vec3 scaled_sum(Vec3 a, Real s, Vec3 b) { return Vec3(mad(a.x, s, b.x), mad(a.y, s, b.y), mad(a.z, s, b.z)); }

// All sample points of a batch are looked up first. A tap that is in front of its sample point in any lane (one of the
// pixels that run together) is kept in these lists and evaluated afterwards.
LIST_REAL(tap_x, kListLength)  // pixel coordinates, integers
LIST_REAL(tap_y, kListLength)
LIST_REAL(tap_depth, kListLength)     // 0 where there is none
LIST_REAL(sample_depth, kListLength)  // depth of the sample point for the camera that sees the tap

// Possible emitters are recorded and evaluated later still, regardless of the sample that found them: at one sample
// point few lanes find an emitter.
CONST int kMaxFound = 2 * kListLength * kLanes;
LIST_UINT(found_pixel, 2 * kListLength)   // column + 65536 x row
LIST_UINT(found_by, 2 * kListLength)      // lane + 256 x index in C.layer
LIST_REAL(found_depth, 2 * kListLength)   // for the layer's own camera
LIST_REAL(hidden_depth, 2 * kListLength)  // of the sample point that it occludes

SUMS(arrived)  // light of each lane's pixel

// Adds the light of the first `found` recorded hits whose entries in C.layer are `first` to C.view_end[first] - 1, the
// layers of one camera.
FN void add_recorded_light(int found, int first, Vec3 position, Vec3 normal, Int own_place) {
  int end = C.view_end[first];
  bool other = C.other[first] != 0;
  Vec3 none = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  for (int at = 0; at < found; at += kLanes) {
    Bool sends = this_lane() + Int(at) < Int(found);
    Uint by = entries_found_by(at);
    Int layer = to_signed(by >> 8);
    if (C.view_end[0] < C.layer_count) {
      sends = sends && layer >= Int(first) && layer < Int(end);
      if (!some(sends)) continue;
    }
    Uint pixel = entries_found_pixel(at);
    Real x = to_real(to_signed(pixel & Uint(0xffffu)));
    Real y = to_real(to_signed(pixel >> 16));
    Int place = select(sends, place_of(x, y), own_place);
    Int lane = select(sends, to_signed(by & Uint(0xffu)), Int(0));
    Vec3 to = of_lane(position, lane);
    Real own_depth = -to.z;
    Real tap = entries_found_depth(at);
    Vec3 seen = position_in_view(first, x, y, tap);
    Vec3 occluder = seen;
    if (other) {
      occluder = rotated_from_view(first, seen - view_translation(first));
      own_depth = depth_in_view(first, to);
    }
    Vec3 way = occluder - to;
    Vec3 facing = none;
    Bool away = sends && !sends;
    for (int i = first; i < end; ++i) {
      Bool here = sends;
      if (end - first > 1) here = here && layer == Int(i);
      if (some(here)) {
        Vec3 its_normal = normal_of(C.layer[i], place);
        if (other) its_normal = rotated_from_view(i, its_normal);
        if (C.back[i] >= 0) {
          // The back has the opposite normal.
          Bool turned = dot(way, its_normal) >= 0.0f;
          its_normal = select(turned, -its_normal, its_normal);
          away = away || (here && turned);
        }
        facing = select(here, its_normal, facing);
      }
    }
    // Emitters that face away are not looked up: their lanes read their own pixel, which is in the cache.
    sends = sends && dot(way, facing) < 0.0f;
    place = select(sends, place, own_place);
    Vec3 sight = Vec3(Real(0.0f), Real(0.0f), Real(-1.0f));
    Real widening = Real(1.0f);
    if (C.orthographic[first] == 0) {
      sight = seen * rsqrt(dot(seen, seen));
      widening = entries_hidden_depth(at) / tap;
    }
    if (other) sight = rotated_from_view(first, sight);
    Real fraction = arriving_share(way, of_lane(normal, lane), facing, sight, widening) *
                    range_weight(own_depth, tap, range_limit(own_depth));
    fraction = select(sends, fraction, Real(0.0f));
    Vec3 sent = none;
    for (int i = first; i < end; ++i) {
      Bool front = sends && !away;
      Bool back = sends && away;
      if (end - first > 1) {
        front = front && layer == Int(i);
        back = back && layer == Int(i);
      }
      if (some(front)) sent = select(front, outgoing_light_of(C.layer[i], place), sent);
      if (C.back[i] >= 0 && some(back)) sent = select(back, outgoing_light_of(C.back[i], place), sent);
    }
    add_to_arrived(lane, sent * fraction);
  }
}

// The surface in front of a sample point, at the centre of pixel (x, y) of the i-th layer.
struct Occluder {
  Bool before;  // it counts as an occluder or an emitter
  Bool hides;
  Real weight;
};

// The receiving pixel.
struct Looking {
  Vec3 position, normal;
  Real depth, limit;  // view depth and range limit for the first camera
  Real rounding, min_height, min_in_front;
};

FN Occluder occluder_at(Looking from, int i, Real x, Real y, Real tap, Real point_depth, Bool hideable) {
  Bool before = tap > 0.0f && point_depth - tap > from.min_in_front;
  Vec3 seen = position_in_view(i, x, y, tap);
  Vec3 occluder = seen;
  Real own_depth = from.depth;
  Real limit = from.limit;
  if (C.other[i] != 0) {
    occluder = rotated_from_view(i, seen - view_translation(i));
    own_depth = depth_in_view(i, from.position);
    limit = range_limit(own_depth);
  }
  Vec3 way = occluder - from.position;
  Real weight = range_weight(own_depth, tap, limit);
  before = before && weight > 0.0f;
  Bool hides = before;
  if (C.other[i] != 0) hides = hides && hideable && dot(way, way) <= Real(C.radius * C.radius);
  if (C.rises != 0) hides = hides && dot(way, from.normal) > from.min_height;
  if (kGathersLight) {
    // Whether it faces the pixel and what it emits is looked up later.
    before = before && dot(way, from.normal) > from.rounding;
    if (C.area == kHemisphereAreaMeasured) before = before && dot(way, way) <= Real(C.radius * C.radius);
  }
  return Occluder(before, hides, weight);
}

// Records a possible emitter in the lanes `where`. Returns the new number of records.
FN int noted(int found, Bool where, int i, Real x, Real y, Real tap, Real point_depth) {
  append_found_pixel(found, where, (to_uint(to_int(y)) << 16) | to_uint(to_int(x)));
  append_found_by(found, where, to_uint(this_lane() + Int(i * 256)));
  append_found_depth(found, where, tap);
  append_hidden_depth(found, where, point_depth);
  return found + count_lanes(where);
}

FN void gather(Int px, Int py) {
  Vec3 none = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  Real depth = near_depth(0, 0);
  Bool surface = is_surface(depth);
  if (!some(surface)) {
    store_ao(Real(1.0f));
    store_light(none);
    return;
  }
  depth = select(surface, depth, Real(1.0f));
  Vec3 position = view_position(px, py, depth);
  Vec3 normal = unit_normal(near_normal(0, 0), position);
  Vec3 noise = noise_at(px, py);
  Vec3 along_z = normal * Real(C.radius);
  Vec3 along_x = turned_tangent(normal, noise) * Real(C.radius);
  Vec3 along_y = cross(normal, along_x);
  Real shorter = C.even != 0 ? exp_of(noise.z * Real(C.log_inner)) : Real(1.0f);

  Real rounding = depth * kDepthRounding;
  Real min_height = rounding + Real(C.min_height);
  Real min_in_front = rounding + Real(C.min_in_front);
  Real min_depth = depth * kMinDepth;
  Looking from = Looking(position, normal, depth, range_limit(depth), rounding, min_height, min_in_front);
  Int own_place = place_of(to_real(px), to_real(py));
  int found_count = 0;
  Real hidden = Real(0.0f);
  Real count = Real(0.0f);
  if (kGathersLight) clear_arrived();
  Real last_column = Real(float(F.width - 1));
  Real last_line = Real(float(F.height - 1));
  // The comparison with a number makes it one of a GPU's options (devices/vulkan/options.h): with one layer the loop
  // disappears.
  int layers = C.layer_count == 1 ? 1 : C.layer_count;
  int at_once = kListLength / layers;
  for (int first = 0; first < C.samples; first += at_once) {
    int end = first + at_once < C.samples ? first + at_once : C.samples;
    int kept = 0;
    int kept_sample[kListLength];
    int kept_layer[kListLength];
    for (int k = first; k < end; ++k) {
      Vec3 v = scaled_sum(along_x, Real(C.points[5 * k]),
                          scaled_sum(along_y, Real(C.points[5 * k + 1]), along_z * Real(C.points[5 * k + 2])));
      Real length = Real(1.0f);
      if (C.even != 0) {
        length = Real(C.points[5 * k + 3]);
        if (k % 2 == 0) {
          length = length * shorter;  // lengths below r0 wrap around to R
          length = select(length < Real(C.inner), length * Real(C.one_over_inner), length);
        } else {
          length = fract(length + noise.z);
        }
      }
      Vec3 point = scaled_sum(v, length, position);
      Bool known = surface && !surface;
      // The first camera sees the sample point itself: it is unoccluded, whatever another camera has in front of it.
      Bool open = known;
      Bool found = known;  // the sample point is already occluded
      // Coordinates for the layer's camera; equal for all layers of one camera.
      Real point_depth = depth;
      Bool inside = surface;
      Real x = depth;
      Real y = depth;
      Int place = own_place;
      for (int i = 0; i < layers; ++i) {
        if (C.new_view[i] != 0) {
          Vec3 there = point;
          if (C.other[i] != 0) there = rotated_to_view(i, point) + view_translation(i);
          point_depth = max(-there.z, min_depth);
          Real shrunk = Real(1.0f);
          if (C.orthographic[i] == 0) shrunk = Real(1.0f) / point_depth;
          x = mad(there.x * shrunk, Real(C.scale_x[i]), Real(C.offset_x[i]));
          y = mad(there.y * shrunk, Real(C.scale_y[i]), Real(C.offset_y[i]));
          Real column = floor(x);
          Real line = floor(y);
          x = clamp(column, Real(0.0f), last_column);
          y = clamp(line, Real(0.0f), last_line);
          place = place_of(x, y);
          inside = surface && x == column && y == line;
          if (C.clamp_border != 0 && C.other[i] == 0) inside = surface;
          if (C.other[i] != 0) inside = inside && depth_in_view(i, position) > 0.0f && -there.z > 0.0f;
          known = known || inside;
        }
        Real tap = select(inside, layers == 1 ? read_depth(place) : read_depth_of(C.layer[i], place), Real(0.0f));
        Bool before = tap > 0.0f && point_depth - tap > min_in_front;
        if (i == 0) open = inside && !before;
        if (kLanes == 1) {
          // With a single lane the tap is evaluated at once.
          Occluder by = occluder_at(from, i, x, y, tap, point_depth, !open);
          Bool hides = by.hides && !found;
          hidden = hidden + select(hides, by.weight * Real(C.points[5 * k + 4]), Real(0.0f));
          found = found || hides;
          if (kGathersLight) found_count = noted(found_count, by.before, i, x, y, tap, point_depth);
        } else {
          keep_tap_x(kept, x);
          keep_tap_y(kept, y);
          keep_tap_depth(kept, tap);
          // Negative: the tap may emit light but does not occlude.
          keep_sample_depth(kept, select(open, -point_depth, point_depth));
          kept_sample[kept] = k;
          kept_layer[kept] = i;
          // Branch-free: whether any lane has a surface in front of its sample is hard to predict.
          kept += some(before) ? 1 : 0;
        }
      }
      count = count + select(known, Real(C.points[5 * k + 4]), Real(0.0f));
    }
    Bool found = surface && !surface;
    for (int slot = 0; slot < kept; ++slot) {
      int i = kept_layer[slot];
      int k = kept_sample[slot];
      if (slot > 0 && k != kept_sample[slot - 1]) found = surface && !surface;
      Real tap = kept_tap_depth(slot);
      Real point_depth = abs(kept_sample_depth(slot));
      Real x = kept_tap_x(slot);
      Real y = kept_tap_y(slot);
      Occluder by = occluder_at(from, i, x, y, tap, point_depth, kept_sample_depth(slot) > 0.0f);
      Bool hides = by.hides && !found;
      hidden = hidden + select(hides, by.weight * Real(C.points[5 * k + 4]), Real(0.0f));
      found = found || hides;
      if (kGathersLight) found_count = noted(found_count, by.before, i, x, y, tap, point_depth);
    }
    if (kGathersLight && (end == C.samples || found_count > kMaxFound - kListLength * kLanes)) {
      for (int i = 0; i < C.layer_count; i = C.view_end[i]) {
        add_recorded_light(found_count, i, position, normal, own_place);
      }
      found_count = 0;
    }
  }
  Real closed = hidden * Real(C.weight) / max(count, Real(1e-6f));
  bool darkens = C.occlusion != 0;
  store_ao(select(surface, darkens ? max(Real(0.0f), 1.0f - closed) : Real(1.0f), Real(1.0f)));
  if (!kGathersLight) return;
  Vec3 light = sum_of_arrived() * Real(C.bleeding);
  light = Vec3(min(light.x, Real(kMaxLight)), min(light.y, Real(kMaxLight)), min(light.z, Real(kMaxLight)));
  store_light(select(surface, finite_or_zero(light), none));
}
