// Directional occlusion [Ritschel et al. 2009]: light arrives from the directions whose sample points are unoccluded;
// the surfaces that hide the others reflect light.
//
// `ao` is the weighted fraction of the open directions. `composite` adds ambient light times `ao`; what its direction
// changes is added to `indirect`. With `difference`, that is
//   (L of open directions) - ao (L of all directions)
// so that an open surface gets no noise; else the second term is ao (L of the normal's whole hemisphere), so that the
// sum is the paper's.
//
// Differs: radiance of ambient light is spherical harmonics up to the second degree, the paper's is a blurred image.
// Differs, for kSsdoRadiance: a hidden direction brings the radiance of the surface that hides it. The paper adds form
// factors of equal patches, whose sum depends on the view.
//
// KERNEL ssdo_occlusion: LIGHT=0
// KERNEL ssdo_light: LIGHT=1
IN_LAYERS_REAL(depth)
IN_VECTOR(normal)
OUT_REAL(ao)
#include "effects/hemisphere/hemisphere_basis.kernel.h"
#include "effects/hemisphere/hemisphere_light.kernel.h"
#include "effects/hemisphere/hemisphere_views.kernel.h"
#include "kernel/sky.kernel.h"

CONST float kDepthRounding = 2e-6f;  // relative to the depth: 16 to 32 ulp of a float
CONST float kMinDepth = 1e-3f;       // min depth of a sample, relative to the pixel's; nearer ones move there
CONST float kSecondNoise = 5.0f;     // the noise times this, modulo 1, moves the directions within their strata
CONST float kMaxLight = 1e18f;       // upper bound of a pixel's light, so that it stays finite

struct Receiver {
  Vec3 position, normal;
  Real rounding;  // allowance for rounding errors of depth, scene units
};

// What a sample point finds.
struct Found {
  Bool counts;  // a camera sees the place of the sample point
  Bool hidden;
  // The surface that hides it: its index in C.layer, its pixel (integers), its depth for the layer's camera.
  Int source;
  Real x, y, depth;
};

// Tests a sample point. It is hidden if it is behind a surface for every camera whose picture contains it.
FN Found found_at(Receiver from, Vec3 point, Bool surface) {
  Bool never = Bool(false);
  Real min_depth = -from.position.z * kMinDepth;
  Found found = Found(never, surface, Int(0), Real(0.0f), Real(0.0f), Real(1.0f));
  Bool found_any = never;
  Bool inside = never;
  Bool in_front = never;  // of the point, for the present camera
  Real point_depth = Real(1.0f);
  Real x = Real(0.0f);
  Real y = Real(0.0f);
  Int place = Int(0);
  for (int i = 0; i < C.layer_count; ++i) {
    if (C.new_view[i] != 0) {
      found.hidden = found.hidden && (in_front || !inside);
      in_front = never;
      Vec3 there = point;
      if (C.other[i] != 0) there = rotated_to_view(i, point) + view_translation(i);
      point_depth = max(-there.z, min_depth);
      Real inverse_spread = Real(1.0f);
      if (C.orthographic[i] == 0) inverse_spread = Real(1.0f) / point_depth;
      Real column = floor(mad(there.x * inverse_spread, Real(C.scale_x[i]), Real(C.offset_x[i])));
      Real row = floor(mad(there.y * inverse_spread, Real(C.scale_y[i]), Real(C.offset_y[i])));
      x = clamp(column, Real(0.0f), Real(float(F.width - 1)));
      y = clamp(row, Real(0.0f), Real(float(F.height - 1)));
      place = place_of(x, y);
      inside = surface && x == column && y == row;
      if (C.other[i] != 0) inside = inside && -there.z > 0.0f;
      found.counts = found.counts || inside;
    }
    Real tap = select(inside, read_depth_of(C.layer[i], place), Real(0.0f));
    Real behind = point_depth - tap;
    Bool hides = tap > 0.0f && behind > from.rounding && behind < Real(C.thickness);
    if (some(hides)) {
      Vec3 occluder = position_in_view(i, x, y, tap);
      if (C.other[i] != 0) occluder = rotated_from_view(i, occluder - view_translation(i));
      hides = hides && dot(occluder - from.position, from.normal) > from.rounding + Real(C.min_height);
      Bool first = hides && !found_any;
      found.source = select(first, Int(i), found.source);
      found.x = select(first, x, found.x);
      found.y = select(first, y, found.y);
      found.depth = select(first, tap, found.depth);
      found_any = found_any || hides;
      in_front = in_front || hides;
    }
  }
  found.hidden = found.hidden && (in_front || !inside) && found_any;
  return found;
}

// Returns the light that arrives from the surfaces that hide sample points in a direction: times pi, divided by the
// direction's weight for kSsdoRadiance.
FN Vec3 light_from(Found found, Receiver from, Vec3 direction) {
  Vec3 light = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  Int place = place_of(found.x, found.y);
  for (int i = 0; i < C.layer_count; ++i) {
    Bool here = found.hidden;
    if (C.layer_count > 1) here = here && found.source == Int(i);
    if (!some(here)) continue;
    Vec3 to_receiver = -direction;
    Vec3 sender = position_in_view(i, found.x, found.y, found.depth);
    Vec3 normal = normal_of(C.layer[i], place);
    if (C.other[i] != 0) {
      sender = rotated_from_view(i, sender - view_translation(i));
      normal = rotated_from_view(i, normal);
    }
    Real weight = Real(1.0f);
    if (C.radiance == 0) {
      // The paper's A_s cos cos / d^2, with the patch A_s = pi R^2 / N, divided by pi and times N.
      to_receiver = from.position - sender;
      Real distance2 = max(dot(to_receiver, to_receiver), Real(1e-30f));
      to_receiver = to_receiver * (Real(1.0f) / sqrt(distance2));
      Real cosines = max(-dot(to_receiver, from.normal), Real(0.0f)) * abs(dot(to_receiver, normal));
      weight = cosines * Real(C.radius2) / max(distance2, Real(C.min_distance2));
    }
    Real facing = dot(to_receiver, normal);
    Vec3 sent = select(here && facing > 0.0f, outgoing_light_of(C.layer[i], place), light);
    if (C.back[i] >= 0) sent = select(here && facing < 0.0f, outgoing_light_of(C.back[i], place), sent);
    light = select(here, sent * weight, light);
  }
  return light;
}

// Sums over directions (x, y, z) of their weights times x, y, z; xx, yy, zz; 2xy, 2yz, 2zx.
struct Moments {
  Vec3 first, squares, products;
};
FN Moments with_direction(Moments sum, Vec3 d, Real weight) {
  Vec3 w = d * weight;
  return Moments(sum.first + w, sum.squares + Vec3(w.x * d.x, w.y * d.y, w.z * d.z),
                 sum.products + Vec3(w.x * d.y, w.y * d.z, w.z * d.x) * 2.0f);
}
// Returns the sum of the weights times L of a colour channel.
FN Real sky_of(int channel, Moments sum) {
  return sky_linear(channel, sum.first) + sky_quadratic_of(channel, sum.squares, sum.products);
}

// Returns L, integrated over the hemisphere of a normal and divided by pi.
FN Real whole_sky(int channel, Vec3 normal) {
  return mad(sky_linear(channel, normal), Real(2.0f / 3.0f), sky_quadratic(channel, normal, normal) * 0.25f);
}

// Returns direction k about the normal; `turned_x`, `turned_y`: the tangents.
FN Vec3 direction_of(int k, Vec3 turned_x, Vec3 turned_y, Vec3 normal, Real noise) {
  int row = kSsdoPointValues * k;
  Real u = (fract(noise + C.points[row + 1]) + C.points[row]) * Real(C.stratum);
  Real height = Real(1.0f) - u;
  Real across = sqrt(max(u, Real(0.0f)));
  if (C.cosine != 0)
    height = sqrt(max(height, Real(0.0f)));
  else
    across = sqrt(max(Real(1.0f) - height * height, Real(0.0f)));
  Vec3 in_plane = turned_x * Real(C.points[row + 2]) + turned_y * Real(C.points[row + 3]);
  return in_plane * across + normal * height;
}

// Computes one pixel: stores `ao` and, if kLight, the light.
FN void ssdo_pixel(Int px, Int py) {
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
  Receiver from = Receiver(position, normal, depth * kDepthRounding);
  Vec3 noise = noise_at(px, py);
  Vec3 turned_x = rotated_tangent(normal, noise);
  Vec3 turned_y = cross(normal, turned_x);
  Real second_noise = fract(noise.z * kSecondNoise);

  Real open_sum = Real(0.0f);
  Real weight_sum = Real(0.0f);
  Vec3 light = none;
  Moments open = Moments(none, none, none);
  Moments all = open;
  for (int k = 0; k < C.samples; ++k) {
    Vec3 direction = direction_of(k, turned_x, turned_y, normal, second_noise);
    Real length_noise = fract(noise.z + C.points[kSsdoPointValues * k + 4]);
    Real weight = Real(1.0f);
    if (C.cosine == 0) weight = dot(direction, normal) * 2.0f;
    Bool counts = Bool(false);
    Bool hidden = counts;
    for (int j = 0; j < C.steps; ++j) {
      Real length = (length_noise + float(j)) * Real(C.one_over_steps);
      if (C.root != 0) length = sqrt(length);
      Found found = found_at(from, position + direction * (length * Real(C.radius)), surface && !hidden);
      counts = counts || found.counts;
      if (kLight && C.bleeding > 0.0f && some(found.hidden)) {
        Real sent_weight = C.radiance != 0 ? weight : Real(1.0f);
        light = light + select(found.hidden, light_from(found, from, direction) * sent_weight, none);
      }
      hidden = hidden || found.hidden;
    }
    if (C.skip_outside == 0) counts = surface;
    weight = select(counts, weight, Real(0.0f));
    Real open_weight = select(hidden, Real(0.0f), weight);
    weight_sum = weight_sum + weight;
    open_sum = open_sum + open_weight;
    if (kLight && C.directional > 0.0f) {
      open = with_direction(open, direction, open_weight);
      if (C.difference != 0) all = with_direction(all, direction, weight);
    }
  }
  Real scale = Real(1.0f) / max(C.normalized != 0 ? weight_sum : Real(float(C.samples)), Real(1e-6f));
  Real ao = select(weight_sum > 0.0f, open_sum * scale, Real(1.0f));
  store_ao(select(surface, ao, Real(1.0f)));
  if (!kLight) return;
  light = light * (scale * C.bleeding);
  if (C.directional > 0.0f) {
    Vec3 of_open = Vec3(sky_of(0, open), sky_of(1, open), sky_of(2, open));
    Vec3 of_all = Vec3(sky_of(0, all), sky_of(1, all), sky_of(2, all)) * scale;
    if (C.difference == 0) of_all = Vec3(whole_sky(0, normal), whole_sky(1, normal), whole_sky(2, normal));
    light = light + (of_open * scale - of_all * ao) * Real(C.directional);
  }
  light = finite_or_zero(light);
  light = Vec3(min(light.x, Real(kMaxLight)), min(light.y, Real(kMaxLight)), min(light.z, Real(kMaxLight)));
  store_light(select(surface, light, none));
}
