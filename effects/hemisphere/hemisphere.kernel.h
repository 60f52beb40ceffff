// Occlusion and reflected light by points in a hemisphere: sample points above a pixel's surface that lie behind what
// the depth buffer holds at their place are occluded, and what hides them sends its light to the pixel. Based on
// [Colliander and Törnquist 2015], "SSAO Pass" and "Calculating Colour Bleed", equation 1.
//
// The text is included by two kernels. They differ in what they define before: normal_of and sent_of, the normal of a
// layer's surface and the light that it sends, store_light, and kGathersLight.
//
// Whether a sample counts hangs on which pixel it falls into, so positions use operations alone that round alike on
// every machine: no rsqrt here before that.
//
// Ours, `measured`: equation 1 is a sum over emitting surface, so each sample must know how much of it stands for. A
// patch dA at Q hides all samples behind it along the ray of sight that are still in the hemisphere. With N samples of
// density p, it is found N dA cos(view) int p dt times on average; so one find stands for 1 / (N cos(view) int p dt).
// Our lengths are even in their logarithm between r0 and R, or even between 0 and R, in the shares a and 1 - a:
//   2 pi p = a / (ln(R/r0) r^3) + (1 - a) / (R r^2)
// With b the distance from P to the ray and t the length along it from there, r^2 = b^2 + t^2, tan(phi) = t/b,
//   int dt / r^3 = sin(phi) / b^2,  int dt / r^2 = phi / b
// The light of one find, over pi, is then
//   2/N  L cos(or) cos(oc)/cos(view)  b^2/d^2 / (a [sin(phi)] / ln(R/r0) + (1 - a) [phi] b/R)
// with [] from Q to the end. Since b^2/d^2 = cos^2(phi at Q), it is bounded however near Q is.
CONST float kDepthRounding = 2e-6f;  // share of the depth: 16 to 32 steps of a float
CONST float kLeastDepth = 1e-3f;     // a sample behind the eye is moved to this share of the pixel's depth
CONST float kLeastSpan = 0.02f;      // of sin(phi) between Q and where the ray leaves the hemisphere; of 2
CONST float kLeastCosine = 0.1f;     // of the angle at which the camera sees an emitter
CONST float kMostFind = 16.0f;       // what one find may stand for, of what it stands for on average: no sparks
CONST float kMostLight = 1e18f;      // what a pixel gets stays a number

#include "effects/hemisphere/hemisphere_basis.kernel.h"

FN Bool is_surface(Real depth) { return depth > 0.0f && is_finite(depth); }

// e^x for x in [-8, 0] by operations that round alike everywhere: the series for x/16, squared four times.
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

// Window depth: what a depth buffer of the frustum between near and far holds.
FN Real window_depth(Real depth) {
  Real between = clamp(depth, Real(C.near_depth), Real(C.far_depth));
  return Real(C.window_one) - Real(C.window_inverse) / between;
}

// By how much depths may differ at a pixel for one to occlude the other.
FN Real range_limit(Real depth) {
  Real fall = Real(C.depth_at_limit) / max(depth, Real(1e-30f));
  Real limit = Real(C.limit);
  if (C.range == kHemisphereRangeLinear) limit = limit * fall;
  if (C.range == kHemisphereRangeQuadratic) limit = limit * fall * fall;
  return clamp(limit, Real(1e-30f), Real(1e30f));
}

// How much an occluder counts by the difference of its depth to the pixel's.
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

// A position as the camera of the i-th layer sees it, or a direction.
FN Vec3 turned_to(int i, Vec3 v) {
  return Vec3(dot(Vec3(Real(C.move[12 * i]), Real(C.move[12 * i + 1]), Real(C.move[12 * i + 2])), v),
              dot(Vec3(Real(C.move[12 * i + 4]), Real(C.move[12 * i + 5]), Real(C.move[12 * i + 6])), v),
              dot(Vec3(Real(C.move[12 * i + 8]), Real(C.move[12 * i + 9]), Real(C.move[12 * i + 10])), v));
}
FN Vec3 added_to(int i) { return Vec3(Real(C.move[12 * i + 3]), Real(C.move[12 * i + 7]), Real(C.move[12 * i + 11])); }
FN Vec3 turned_back(int i, Vec3 v) {
  return Vec3(dot(Vec3(Real(C.move[12 * i]), Real(C.move[12 * i + 4]), Real(C.move[12 * i + 8])), v),
              dot(Vec3(Real(C.move[12 * i + 1]), Real(C.move[12 * i + 5]), Real(C.move[12 * i + 9])), v),
              dot(Vec3(Real(C.move[12 * i + 2]), Real(C.move[12 * i + 6]), Real(C.move[12 * i + 10])), v));
}

// Antiderivative of the samples' density along a ray of sight, times b^2: sin(phi), without what lies within r0.
FN Real passed(Real sine, Real inner_sine) {
  Real beyond = max(abs(sine) - inner_sine, Real(0.0f));
  return select(sine < 0.0f, -beyond, beyond);
}

// The angle from 0 to pi of the direction (x, y), y >= 0: exact at every eighth of a turn, within 1 % between.
FN Real angle_of(Real x, Real y) {
  Real m = y / max(abs(x) + y, Real(1e-30f));
  Real bow = m * (1.0f - m);
  Real angle = mad(bow * mad(m, Real(2.0f), Real(-1.0f)), mad(bow, Real(0.99f), Real(0.5707963f)), m * 1.5707963f);
  return select(x < 0.0f, Real(3.1415927f) - angle, angle);
}

// What one find stands for: the light that arrives by it over pi, for emitted light 1. `way` leads from the pixel to
// the emitter, whose normal is `facing`; `sight` is the unit direction in which the camera sees it, `widening` how much
// farther away than the emitter the sample is.
FN Real arriving_share(Vec3 way, Vec3 normal, Vec3 facing, Vec3 sight, Real widening) {
  Real squared = max(dot(way, way), Real(1e-30f));
  Real one_over = rsqrt(squared);
  Real height = dot(way, normal);
  Real cos_receiver = height * one_over;
  Real cos_emitter = -dot(way, facing) * one_over;
  Bool sees = cos_receiver > 0.0f && cos_emitter > 0.0f;
  Real share = cos_receiver * min(cos_emitter, Real(1.0f)) * Real(C.area_factor);
  if (C.area == kHemisphereAreaMeasured) {
    Real t = dot(way, sight);
    Real b2 = max(squared - t * t, Real(C.least_b2));
    Real end2 = max(Real(C.radius * C.radius) - b2, Real(0.0f));
    Real end = end2 * rsqrt(max(end2, Real(1e-30f)));
    if (C.above != 0) {
      // Where the ray dives below the surface there are no samples any more.
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
    Real found = max(end_sine - near_sine, inner_share * kLeastSpan) * Real(C.log_share);
    found = mad(seen_angle * foot, Real(C.even_share_by_radius), found);
    Real cos_view = max(abs(dot(sight, facing)), Real(kLeastCosine));
    // Rays of sight part from each other: farther away there are more samples between them.
    share = share * (b2 * one_over_near * one_over_near) / (cos_view * found * (widening * widening));
    share = min(share, Real(C.area_factor * kMostFind));
    sees = sees && squared <= Real(C.radius * C.radius);
  } else {
    share = share / max(squared, Real(C.least_distance * C.least_distance));
  }
  return select(sees, share, Real(0.0f));
}

// A position that the camera of the i-th layer sees at the middle of a pixel, in that camera's space. The pixel's
// coordinates are whole numbers.
FN Vec3 seen_position(int i, Real x, Real y, Real depth) {
  Real spread = C.orthographic[i] != 0 ? Real(1.0f) : depth;
  return Vec3(mad(x + 0.5f, Real(C.ray_scale_x[i]), Real(C.ray_offset_x[i])) * spread,
              mad(y + 0.5f, Real(C.ray_scale_y[i]), Real(C.ray_offset_y[i])) * spread, -depth);
}

// a s + b.
FN Vec3 scaled_on(Vec3 a, Real s, Vec3 b) { return Vec3(mad(a.x, s, b.x), mad(a.y, s, b.y), mad(a.z, s, b.z)); }

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
  Real least_height = rounding + Real(C.least_height);
  Real least_nearer = rounding + Real(C.least_nearer);
  Real least_depth = depth * kLeastDepth;
  Real hidden = Real(0.0f);
  Real count = Real(0.0f);
  Vec3 light = none;
  for (int k = 0; k < C.samples; ++k) {
    Vec3 v = scaled_on(along_x, Real(C.points[5 * k]),
                       scaled_on(along_y, Real(C.points[5 * k + 1]), along_z * Real(C.points[5 * k + 2])));
    Real length = Real(1.0f);
    if (C.even != 0) {
      length = Real(C.points[5 * k + 3]);
      if (k % 2 == 0) {
        length = length * shorter;  // what would be shorter than r0 goes on at R
        length = select(length < Real(C.inner), length * Real(C.one_over_inner), length);
      } else {
        length = fract(length + noise.z);
      }
    }
    Real counts = Real(C.points[5 * k + 4]);
    Vec3 point = scaled_on(v, length, position);
    Bool found = surface && !surface;  // nowhere yet
    Bool known = found;
    // As the layer's camera sees it; the same for layers of one camera.
    Real point_depth = depth;
    Real own_depth = depth;
    Real limit = depth;
    Bool inside = surface;
    Real x = depth;
    Real y = depth;
    for (int i = 0; i < C.layer_count; ++i) {
      if (C.new_view[i] != 0) {
        Vec3 there = point;
        own_depth = depth;
        if (C.other[i] != 0) {
          there = turned_to(i, point) + added_to(i);
          own_depth = -(turned_to(i, position) + added_to(i)).z;
        }
        limit = range_limit(own_depth);
        point_depth = max(-there.z, least_depth);
        Real shrunk = Real(1.0f);
        if (C.orthographic[i] == 0) shrunk = Real(1.0f) / point_depth;
        x = mad(there.x * shrunk, Real(C.scale_x[i]), Real(C.offset_x[i]));
        y = mad(there.y * shrunk, Real(C.scale_y[i]), Real(C.offset_y[i]));
        Real column = floor(x);
        Real line = floor(y);
        x = clamp(column, Real(0.0f), Real(float(F.width - 1)));
        y = clamp(line, Real(0.0f), Real(float(F.height - 1)));
        inside = x == column && y == line;
        if (C.clamp_border != 0 && C.other[i] == 0) inside = surface;
        if (C.other[i] != 0) inside = inside && own_depth > 0.0f && -there.z > 0.0f;
        known = known || inside;
      }
      Real tap = load_depth_of(C.layer[i], to_int(x), to_int(y));
      Bool before = inside && tap > 0.0f && point_depth - tap > least_nearer;
      if (some(before)) {
        Vec3 seen = seen_position(i, x, y, tap);
        Vec3 occluder = seen;
        if (C.other[i] != 0) occluder = turned_back(i, seen - added_to(i));
        Vec3 way = occluder - position;
        Real weight = range_weight(own_depth, tap, limit);
        before = before && weight > 0.0f;
        Bool hides = before && !found;
        if (C.rises != 0) hides = hides && dot(way, normal) > least_height;
        hidden = hidden + select(hides, weight * counts, Real(0.0f));
        found = found || hides;
        if (kGathersLight) {
          // The rest of it hangs on the emitter.
          before = before && dot(way, normal) > rounding;
          if (C.area == kHemisphereAreaMeasured) before = before && dot(way, way) <= Real(C.radius * C.radius);
        }
        if (kGathersLight && some(before)) {
          // Lanes that have no occluder read their own pixel, which is at hand.
          Int column = select(before, to_int(x), px);
          Int row = select(before, to_int(y), py);
          Vec3 facing = normal_of(C.layer[i], column, row);
          Vec3 sight = Vec3(Real(0.0f), Real(0.0f), Real(-1.0f));
          if (C.orthographic[i] == 0) sight = seen * rsqrt(dot(seen, seen));
          if (C.other[i] != 0) {
            facing = turned_back(i, facing);
            sight = turned_back(i, sight);
          }
          Bool away = dot(way, facing) >= 0.0f;
          bool both_sides = C.back[i] >= 0 && some(before && away);
          if (both_sides) {
            Vec3 back = normal_of(C.back[i], column, row);
            if (C.other[i] != 0) back = turned_back(i, back);
            facing = select(away, back, facing);
          }
          if (!both_sides) before = before && !away;
          if (some(before)) {
            Real widening = C.orthographic[i] != 0 ? Real(1.0f) : point_depth / tap;
            Real share = arriving_share(way, normal, facing, sight, widening) * weight;
            before = before && share > 0.0f;
            column = select(before, column, px);
            row = select(before, row, py);
            Vec3 sent = sent_of(C.layer[i], column, row);
            if (both_sides) sent = select(away, sent_of(C.back[i], column, row), sent);
            light = light + sent * select(before, share, Real(0.0f));
          }
        }
      }
    }
    count = count + select(known, counts, Real(0.0f));
  }
  Real closed = hidden * Real(C.weight) / max(count, Real(1e-6f));
  bool darkens = C.occlusion != 0;
  store_ao(select(surface, darkens ? max(Real(0.0f), 1.0f - closed) : Real(1.0f), Real(1.0f)));
  light = light * Real(C.bleeding);
  light = Vec3(min(light.x, Real(kMostLight)), min(light.y, Real(kMostLight)), min(light.z, Real(kMostLight)));
  store_light(select(surface, finite_or_zero(light), none));
}
