// Occlusion and reflected light from sample points in a hemisphere above a pixel's surface. A sample point is occluded
// if the depth buffer has a surface in front of it; this surface, the occluder, reflects light to the pixel. Based on
// [Colliander and Törnquist 2015], "SSAO Pass" and "Calculating Colour Bleed", equation 1.
//
// KERNEL hemisphere_occlusion: LIGHT=0
// KERNEL hemisphere_bleeding: LIGHT=1
//
// Whether a sample counts depends on the pixel to which it projects. The computation of this pixel therefore uses only
// operations that round identically on every machine, so no rsqrt.
//
// Differs, for `area=measured`: equation 1 is a sum over the emitting surface, so the area that each hit (occluded
// sample) represents must be known. A patch dA at Q occludes all samples of the hemisphere that are behind it on its
// view ray. With N samples of density p, N dA cos(view) int p dt samples hit it on average, so one hit represents the
// area 1 / (N cos(view) int p dt). A fraction a of our lengths is uniform in the logarithm between r0 and R, the
// fraction 1 - a is uniform between 0 and R:
//   2 pi p = a / (ln(R/r0) r^3) + (1 - a) / (R r^2)
// Let b be the distance from the pixel's point P to the ray, t the length along the ray from the point nearest to P,
// r^2 = b^2 + t^2, and tan(phi) = t/b. Then
//   int dt / r^3 = sin(phi) / b^2,  int dt / r^2 = phi / b
// The light of one hit, divided by pi, is then
//   2/N  L cos(or) cos(oc)/cos(view)  b^2/d^2 / (a [sin(phi)] / ln(R/r0) + (1 - a) [phi] b/R)
// where d is the distance from P to Q, and [] the difference between the point where the ray leaves the hemisphere and
// Q. Since b^2/d^2 = cos^2(phi at Q), the light is bounded, however near Q is.
IN_LAYERS_REAL(depth)
IN_VECTOR(normal)
OUT_REAL(ao)
#include "effects/hemisphere/hemisphere_light.kernel.h"

CONST float kDepthRounding = 2e-6f;  // relative to the depth: 16 to 32 ulp of a float
CONST float kMinDepth = 1e-3f;       // min depth of a sample, relative to the pixel's; nearer ones move there
CONST float kMinSpan = 0.02f;        // lower bound of [sin(phi)], whose range is 0 to 2
CONST float kMinCosine = 0.1f;       // lower bound of cos(view)
CONST float kMaxHitWeight = 16.0f;   // upper bound of a hit's weight, relative to the average: avoids fireflies
CONST float kMaxLight = 1e18f;       // upper bound of a pixel's light, so that it stays finite

#include "effects/hemisphere/hemisphere_basis.kernel.h"
#include "effects/hemisphere/hemisphere_views.kernel.h"

// Returns e^x for x in [-8, 0], with operations that round identically on every machine: the series for e^(x/16),
// squared four times.
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

// Converts view depth to window depth, for the planes C.near_depth and C.far_depth.
FN Real window_depth(Real depth) {
  Real between = clamp(depth, Real(C.near_depth), Real(C.far_depth));
  return Real(C.window_one) - Real(C.window_inverse) / between;
}

// Returns the limit of the difference in depth between an occluder and a pixel at this depth.
FN Real range_limit(Real depth) {
  Real limit = Real(C.limit);
  if (C.range == kHemisphereRangeLinear || C.range == kHemisphereRangeQuadratic) {
    Real fall = Real(C.depth_at_limit) / max(depth, Real(1e-30f));
    limit = limit * fall;
    if (C.range == kHemisphereRangeQuadratic) limit = limit * fall;
  }
  return clamp(limit, Real(1e-30f), Real(1e30f));
}

// Returns the weight of an occluder at the depth `tap` for a pixel at `depth`, by the difference of the two depths.
// `limit`: range_limit(depth).
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

// Returns the antiderivative of 1 / r^3 along a view ray, times b^2, which is sin(phi). Log samples have lengths above
// r0, so that the part of the ray nearer than r0 adds nothing. `inner_sine`: sin(phi) at r0.
FN Real clipped_sine(Real sine, Real inner_sine) {
  Real beyond = max(abs(sine) - inner_sine, Real(0.0f));
  return select(sine < 0.0f, -beyond, beyond);
}

// Returns the angle, 0 to pi, of the direction (x, y) with y >= 0. Exact at multiples of 45 degrees; error elsewhere at
// most 1 %.
FN Real angle_of(Real x, Real y) {
  Real m = y / max(abs(x) + y, Real(1e-30f));
  Real bow = m * (1.0f - m);
  Real angle = mad(bow * mad(m, Real(2.0f), Real(-1.0f)), mad(bow, Real(0.99f), Real(0.5707963f)), m * 1.5707963f);
  return select(x < 0.0f, Real(3.1415927f) - angle, angle);
}

// Returns the weight of one hit: the light that arrives from the area it represents, divided by pi, if the emitted
// light is 1. `to_emitter`: from the pixel to the emitter. `view_ray`: the unit direction from the camera to the
// emitter. `depth_ratio`: the sample's depth divided by the emitter's.
FN Real hit_weight(Vec3 to_emitter, Vec3 normal, Vec3 emitter_normal, Vec3 view_ray, Real depth_ratio) {
  Real distance2 = max(dot(to_emitter, to_emitter), Real(1e-30f));
  Real inverse_distance = rsqrt(distance2);
  Real height = dot(to_emitter, normal);
  Real cos_receiver = height * inverse_distance;
  Real cos_emitter = -dot(to_emitter, emitter_normal) * inverse_distance;
  Bool sees = cos_receiver > 0.0f && cos_emitter > 0.0f;
  Real weight = cos_receiver * min(cos_emitter, Real(1.0f)) * Real(C.area_factor);
  if (C.area == kHemisphereAreaMeasured) {
    Real t = dot(to_emitter, view_ray);
    Real b2 = max(distance2 - t * t, Real(C.min_b2));
    Real end2 = max(Real(C.radius * C.radius) - b2, Real(0.0f));
    Real end = end2 * rsqrt(max(end2, Real(1e-30f)));
    if (C.above != 0) {
      // The part of the ray below the surface has no samples.
      Real descent = -dot(view_ray, normal);
      Real below = t + height / max(descent, Real(1e-6f));
      end = select(descent > 1e-6f, min(end, below), end);
    }
    Real inner_fraction = min(b2 * Real(C.one_over_inner2), Real(1.0f));
    Real inner_sine = sqrt(Real(1.0f) - inner_fraction);
    Real one_over_near = rsqrt(mad(t, t, b2));
    Real near_sine = clipped_sine(t * one_over_near, inner_sine);
    Real end_sine = clipped_sine(end * rsqrt(mad(end, end, b2)), inner_sine);
    Real b = b2 * rsqrt(b2);
    Real span = angle_of(mad(t, end, b2), max(end - t, Real(0.0f)) * b);
    Real hits = max(end_sine - near_sine, inner_fraction * kMinSpan) * Real(C.log_density);
    hits = mad(span * b, Real(C.even_density), hits);
    Real cos_view = max(abs(dot(view_ray, emitter_normal)), Real(kMinCosine));
    // View rays diverge, so that at the depth of the sample they span depth_ratio^2 times the area of the patch.
    weight = weight * (b2 * one_over_near * one_over_near) / (cos_view * hits * (depth_ratio * depth_ratio));
    weight = min(weight, Real(C.area_factor * kMaxHitWeight));
    sees = sees && distance2 <= Real(C.radius * C.radius);
  } else {
    weight = weight / max(distance2, Real(C.min_distance * C.min_distance));
  }
  return select(sees, weight, Real(0.0f));
}

// Returns a s + b.
FN Vec3 scaled_sum(Vec3 a, Real s, Vec3 b) { return Vec3(mad(a.x, s, b.x), mad(a.y, s, b.y), mad(a.z, s, b.z)); }

// For a batch of sample points, the kernel first reads all taps. It keeps a tap in these lists if the tap is in front
// of its sample point in any lane (one of the pixels that run together), and evaluates the kept taps afterwards.
LIST_REAL(tap_x, kListLength)  // pixel coordinates, integers
LIST_REAL(tap_y, kListLength)
LIST_REAL(tap_depth, kListLength)     // 0 in lanes without a surface
LIST_REAL(sample_depth, kListLength)  // depth of the sample point for the tap's camera; sign: see gather()

// Possible emitters are recorded and evaluated in a third step, in which every lane takes an emitter of any lane: at
// one sample point, few lanes find an emitter.
CONST int kMaxFound = 2 * kListLength * kLanes;
LIST_UINT(found_pixel, 2 * kListLength)         // column + 65536 x row
LIST_UINT(found_source, 2 * kListLength)        // lane + 256 x index in C.layer
LIST_REAL(found_depth, 2 * kListLength)         // of the emitter, for the layer's own camera
LIST_REAL(found_sample_depth, 2 * kListLength)  // of the occluded sample point, for that camera

SUMS(arrived)  // light that arrives at each lane's pixel

// Adds the light of recorded hits in the layers of one camera, the entries `first` to C.view_end[first] - 1 of C.layer.
// `found`: number of records, of all cameras.
FN void add_recorded_light(int found, int first, Vec3 position, Vec3 normal, Int own_place) {
  int end = C.view_end[first];
  bool other_camera = C.other[first] != 0;
  Vec3 none = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  for (int first_record = 0; first_record < found; first_record += kLanes) {
    Bool sends = this_lane() + Int(first_record) < Int(found);
    Uint source = entries_found_source(first_record);
    Int layer = to_signed(source >> 8);
    if (C.view_end[0] < C.layer_count) {
      sends = sends && layer >= Int(first) && layer < Int(end);
      if (!some(sends)) continue;
    }
    Uint pixel = entries_found_pixel(first_record);
    Real x = to_real(to_signed(pixel & Uint(0xffffu)));
    Real y = to_real(to_signed(pixel >> 16));
    Int place = select(sends, place_of(x, y), own_place);
    Int lane = select(sends, to_signed(source & Uint(0xffu)), Int(0));
    Vec3 receiver = lane_value(position, lane);
    Real receiver_depth = -receiver.z;
    Real emitter_depth = entries_found_depth(first_record);
    Vec3 position_there = position_in_view(first, x, y, emitter_depth);
    Vec3 emitter = position_there;
    if (other_camera) {
      emitter = rotated_from_view(first, position_there - view_translation(first));
      receiver_depth = depth_in_view(first, receiver);
    }
    Vec3 to_emitter = emitter - receiver;
    Vec3 emitter_normal = none;
    Bool shows_back = Bool(false);
    for (int i = first; i < end; ++i) {
      Bool in_layer = sends;
      if (end - first > 1) in_layer = in_layer && layer == Int(i);
      if (some(in_layer)) {
        Vec3 front_normal = normal_of(C.layer[i], place);
        if (other_camera) front_normal = rotated_from_view(i, front_normal);
        if (C.back[i] >= 0) {
          // The back side has the opposite normal.
          Bool back_faces_pixel = dot(to_emitter, front_normal) >= 0.0f;
          front_normal = select(back_faces_pixel, -front_normal, front_normal);
          shows_back = shows_back || (in_layer && back_faces_pixel);
        }
        emitter_normal = select(in_layer, front_normal, emitter_normal);
      }
    }
    // The light of emitters that face away is not read: their lanes read their own pixel, which is in the cache.
    sends = sends && dot(to_emitter, emitter_normal) < 0.0f;
    place = select(sends, place, own_place);
    Vec3 view_ray = Vec3(Real(0.0f), Real(0.0f), Real(-1.0f));
    Real depth_ratio = Real(1.0f);
    if (C.orthographic[first] == 0) {
      view_ray = position_there * rsqrt(dot(position_there, position_there));
      depth_ratio = entries_found_sample_depth(first_record) / emitter_depth;
    }
    if (other_camera) view_ray = rotated_from_view(first, view_ray);
    Real weight = hit_weight(to_emitter, lane_value(normal, lane), emitter_normal, view_ray, depth_ratio) *
                  range_weight(receiver_depth, emitter_depth, range_limit(receiver_depth));
    weight = select(sends, weight, Real(0.0f));
    Vec3 sent = none;
    for (int i = first; i < end; ++i) {
      Bool front = sends && !shows_back;
      Bool back = sends && shows_back;
      if (end - first > 1) {
        front = front && layer == Int(i);
        back = back && layer == Int(i);
      }
      if (some(front)) sent = select(front, outgoing_light_of(C.layer[i], place), sent);
      if (C.back[i] >= 0 && some(back)) sent = select(back, outgoing_light_of(C.back[i], place), sent);
    }
    add_to_arrived(lane, sent * weight);
  }
}

// The surface that a tap found for a sample point.
struct Occluder {
  Bool in_front;  // whether it is in front of the sample point, in range, and may emit light
  Bool occludes;  // whether it occludes the sample point
  Real weight;    // of its occlusion, by range
};

// The receiving pixel.
struct Receiver {
  Vec3 position, normal;
  Real depth, limit;              // view depth and range limit for the first camera
  Real rounding;                  // allowance for rounding errors of depth, scene units
  Real min_height, min_in_front;  // as in HemisphereConstants, plus `rounding`
};

// Evaluates the tap at pixel (x, y) of layer i. `tap`, `point_depth`: depths of the tap and of the sample point, for
// the camera of the layer. `may_occlude`: whether a surface seen by another camera may occlude the sample point.
FN Occluder occluder_at(Receiver from, int i, Real x, Real y, Real tap, Real point_depth, Bool may_occlude) {
  Bool in_front = tap > 0.0f && point_depth - tap > from.min_in_front;
  Vec3 position_there = position_in_view(i, x, y, tap);
  Vec3 occluder = position_there;
  Real receiver_depth = from.depth;
  Real limit = from.limit;
  if (C.other[i] != 0) {
    occluder = rotated_from_view(i, position_there - view_translation(i));
    receiver_depth = depth_in_view(i, from.position);
    limit = range_limit(receiver_depth);
  }
  Vec3 to_occluder = occluder - from.position;
  Real weight = range_weight(receiver_depth, tap, limit);
  in_front = in_front && weight > 0.0f;
  Bool occludes = in_front;
  if (C.other[i] != 0) occludes = occludes && may_occlude && dot(to_occluder, to_occluder) <= Real(C.radius * C.radius);
  if (C.rises != 0) occludes = occludes && dot(to_occluder, from.normal) > from.min_height;
  if (kLight) {
    // add_recorded_light() finds out whether the surface faces the pixel, and what it emits.
    in_front = in_front && dot(to_occluder, from.normal) > from.rounding;
    if (C.area == kHemisphereAreaMeasured)
      in_front = in_front && dot(to_occluder, to_occluder) <= Real(C.radius * C.radius);
  }
  return Occluder(in_front, occludes, weight);
}

// Records a possible emitter in the lanes of `mask`. Returns the new number of records.
FN int record_emitters(int found, Bool mask, int i, Real x, Real y, Real tap, Real point_depth) {
  append_found_pixel(found, mask, (to_uint(to_int(y)) << 16) | to_uint(to_int(x)));
  append_found_source(found, mask, to_uint(this_lane() + Int(i * 256)));
  append_found_depth(found, mask, tap);
  append_found_sample_depth(found, mask, point_depth);
  return found + count_lanes(mask);
}

// Computes one pixel: stores `ao` and, if kLight, the gathered light.
FN void hemisphere_pixel(Int px, Int py) {
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
  Vec3 along_x = rotated_tangent(normal, noise) * Real(C.radius);
  Vec3 along_y = cross(normal, along_x);
  Real length_factor = C.even != 0 ? exp_of(noise.z * Real(C.log_inner)) : Real(1.0f);

  Real rounding = depth * kDepthRounding;
  Real min_height = rounding + Real(C.min_height);
  Real min_in_front = rounding + Real(C.min_in_front);
  Real min_depth = depth * kMinDepth;
  Receiver from = Receiver(position, normal, depth, range_limit(depth), rounding, min_height, min_in_front);
  Int own_place = place_of(to_real(px), to_real(py));
  int found_count = 0;
  Real occluded_sum = Real(0.0f);
  Real weight_sum = Real(0.0f);
  if (kLight) clear_arrived();
  Real max_column = Real(float(F.width - 1));
  Real max_row = Real(float(F.height - 1));
  // The comparison with a number lets a GPU compile the layer count into its shader (devices/vulkan/options.h); with
  // one layer, the loop disappears.
  int layers = C.layer_count == 1 ? 1 : C.layer_count;
  int batch_size = kListLength / layers;
  for (int first = 0; first < C.samples; first += batch_size) {
    int end = first + batch_size < C.samples ? first + batch_size : C.samples;
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
          length = length * length_factor;  // lengths below r0 wrap around to R
          length = select(length < Real(C.inner), length * Real(C.one_over_inner), length);
        } else {
          length = fract(length + noise.z);
        }
      }
      Vec3 point = scaled_sum(v, length, position);
      Bool counts = Bool(false);
      // Whether the first camera sees the sample point itself. If so, the point is unoccluded, whatever surface another
      // camera sees in front of it.
      Bool unoccluded = counts;
      Bool is_occluded = counts;  // the sample point is already occluded
      // Depth and pixel of the sample point for the layer's camera. All layers of one camera share them.
      Real point_depth = depth;
      Bool inside = surface;
      Real x = depth;
      Real y = depth;
      Int place = own_place;
      for (int i = 0; i < layers; ++i) {
        if (C.new_view[i] != 0) {
          Vec3 position_there = point;
          if (C.other[i] != 0) position_there = rotated_to_view(i, point) + view_translation(i);
          point_depth = max(-position_there.z, min_depth);
          Real inverse_spread = Real(1.0f);
          if (C.orthographic[i] == 0) inverse_spread = Real(1.0f) / point_depth;
          x = mad(position_there.x * inverse_spread, Real(C.scale_x[i]), Real(C.offset_x[i]));
          y = mad(position_there.y * inverse_spread, Real(C.scale_y[i]), Real(C.offset_y[i]));
          Real column = floor(x);
          Real row = floor(y);
          x = clamp(column, Real(0.0f), max_column);
          y = clamp(row, Real(0.0f), max_row);
          place = place_of(x, y);
          inside = surface && x == column && y == row;
          if (C.clamp_border != 0 && C.other[i] == 0) inside = surface;
          if (C.other[i] != 0) inside = inside && depth_in_view(i, position) > 0.0f && -position_there.z > 0.0f;
          counts = counts || inside;
        }
        Real tap = select(inside, layers == 1 ? read_depth(place) : read_depth_of(C.layer[i], place), Real(0.0f));
        Bool in_front = tap > 0.0f && point_depth - tap > min_in_front;
        if (i == 0) unoccluded = inside && !in_front;
        if (kLanes == 1) {
          // With a single lane, a tap is evaluated immediately.
          Occluder occluder = occluder_at(from, i, x, y, tap, point_depth, !unoccluded);
          Bool occludes = occluder.occludes && !is_occluded;
          occluded_sum = occluded_sum + select(occludes, occluder.weight * Real(C.points[5 * k + 4]), Real(0.0f));
          is_occluded = is_occluded || occludes;
          if (kLight) found_count = record_emitters(found_count, occluder.in_front, i, x, y, tap, point_depth);
        } else {
          keep_tap_x(kept, x);
          keep_tap_y(kept, y);
          keep_tap_depth(kept, tap);
          // The sign is negative if the tap may emit light but cannot occlude.
          keep_sample_depth(kept, select(unoccluded, -point_depth, point_depth));
          kept_sample[kept] = k;
          kept_layer[kept] = i;
          // This has no branch, which would be hard to predict. A slot is kept if any lane has a surface in front.
          kept += some(in_front) ? 1 : 0;
        }
      }
      weight_sum = weight_sum + select(counts, Real(C.points[5 * k + 4]), Real(0.0f));
    }
    Bool is_occluded = Bool(false);
    for (int slot = 0; slot < kept; ++slot) {
      int i = kept_layer[slot];
      int k = kept_sample[slot];
      if (slot > 0 && k != kept_sample[slot - 1]) is_occluded = Bool(false);
      Real tap = kept_tap_depth(slot);
      Real point_depth = abs(kept_sample_depth(slot));
      Real x = kept_tap_x(slot);
      Real y = kept_tap_y(slot);
      Occluder occluder = occluder_at(from, i, x, y, tap, point_depth, kept_sample_depth(slot) > 0.0f);
      Bool occludes = occluder.occludes && !is_occluded;
      occluded_sum = occluded_sum + select(occludes, occluder.weight * Real(C.points[5 * k + 4]), Real(0.0f));
      is_occluded = is_occluded || occludes;
      if (kLight) found_count = record_emitters(found_count, occluder.in_front, i, x, y, tap, point_depth);
    }
    if (kLight && (end == C.samples || found_count > kMaxFound - kListLength * kLanes)) {
      for (int i = 0; i < C.layer_count; i = C.view_end[i]) {
        add_recorded_light(found_count, i, position, normal, own_place);
      }
      found_count = 0;
    }
  }
  Real occlusion = occluded_sum * Real(C.weight) / max(weight_sum, Real(1e-6f));
  bool stores_occlusion = C.occlusion != 0;
  store_ao(select(surface, stores_occlusion ? max(Real(0.0f), 1.0f - occlusion) : Real(1.0f), Real(1.0f)));
  if (!kLight) return;
  Vec3 light = sum_of_arrived() * Real(C.bleeding);
  light = Vec3(min(light.x, Real(kMaxLight)), min(light.y, Real(kMaxLight)), min(light.z, Real(kMaxLight)));
  store_light(select(surface, finite_or_zero(light), none));
}
