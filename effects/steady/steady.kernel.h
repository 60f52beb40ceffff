// Joins the occlusion and indirect light of another frame of a sequence: each surface point of this frame, which is at
// `there` in the other one, takes the mean of the pixels there that show its surface. Runs once for each other frame;
// `steady_weight` is the sum of weights so far.
// KERNEL steady_ao: LIGHT=0 RAYS=0
// KERNEL steady_light: LIGHT=1 RAYS=0
// KERNEL steady_ao_rays: LIGHT=0 RAYS=1
// KERNEL steady_light_rays: LIGHT=1 RAYS=1
IN_REAL(other_depth)
IN_VECTOR(other_normal)
IN_REAL(other_ao)
INOUT_REAL(ao)
INOUT_REAL(steady_weight)
#if RAYS == 1
IN_REAL(other_traced_confidence)
INOUT_REAL(traced_confidence)
#endif
#if LIGHT == 1
IN_COLOR(other_indirect)
INOUT_COLOR(indirect)
#endif
#include "kernel/surface.kernel.h"
IN_REAL(depth)
IN_VECTOR(normal)
IN_VECTOR(there)
IN_REAL(steady_change)

// Taps to each side whose mean change is compared, and their distance in pixels.
CONST int kChangeTaps = 2;
CONST int kChangeStep = 2;

// A frame counts from this part of the bilinear weights on, fully from twice that on.
CONST float kMinFound = 0.25f;

// Returns the number of rays.
FN Real rays_of(Real confidence) { return confidence / max(Real(1.0f) - confidence, Real(1e-3f)); }

// Return the weight of this pixel's value, and of pixel (x, y) of the other frame: the number of rays, or 1.
#if RAYS == 1
FN Real own_weight() { return rays_of(own_traced_confidence()); }
FN Real weight_there(Int x, Int y) { return rays_of(load_other_traced_confidence(x, y)); }
#else
FN Real own_weight() { return Real(1.0f); }
FN Real weight_there(Int x, Int y) { return Real(1.0f); }
#endif

FN Vec3 turned_there(Vec3 v) {
  return Vec3(mad(v.x, Real(C.x[0]), mad(v.y, Real(C.x[1]), v.z * C.x[2])),
              mad(v.x, Real(C.y[0]), mad(v.y, Real(C.y[1]), v.z * C.y[2])),
              mad(v.x, Real(C.z[0]), mad(v.y, Real(C.z[1]), v.z * C.z[2])));
}

// Returns the view-space position of the centre of pixel (column, row) of the other frame.
FN Vec3 position_there(Real column, Real row, Real depth) {
  Real spread = F.orthographic != 0 ? Real(1.0f) : depth;
  return Vec3(mad(column + 0.5f, Real(C.ray_scale_x), Real(C.ray_offset_x)) * spread,
              mad(row + 0.5f, Real(C.ray_scale_y), Real(C.ray_offset_y)) * spread, -depth);
}

// Returns the weight of the other frame by the change of occlusion around, of the same surface: its mean has less noise
// than that of a pixel.
FN Real unchanged(Int px, Int py) {
  if (C.less_above == 0.0f) return Real(1.0f);
  Vec3 position = view_position(px, py, near_depth(0, 0));
  Vec3 normal = near_normal(0, 0);
  Real sum = Real(0.0f);
  Real count = Real(1e-6f);
  for (int j = -kChangeTaps * kChangeStep; j <= kChangeTaps * kChangeStep; j += kChangeStep)
    for (int i = -kChangeTaps * kChangeStep; i <= kChangeTaps * kChangeStep; i += kChangeStep) {
      Real change = near_steady_change(i, j);
      Real distance = surface_distance(position, normal, view_position(px + Int(i), py + Int(j), near_depth(i, j)),
                                       near_normal(i, j), 2.0f * C.distance);
      Bool known = near_inside(i, j) && change < kSteadyUnknown && distance <= 1.0f;
      sum = sum + select(known, change, Real(0.0f));
      count = count + select(known, Real(1.0f), Real(0.0f));
    }
  // The standard error of the mean is larger with fewer pixels.
  Real known_part = sqrt(count * (1.0f / float((2 * kChangeTaps + 1) * (2 * kChangeTaps + 1))));
  return clamp(2.0f - abs(sum / count) * known_part * C.less_above, Real(0.0f), Real(1.0f));
}

FN void steady_pixel(Int px, Int py) {
  Real own = clean_ao(own_ao());
#if LIGHT == 1
  Vec3 light = own_indirect();
  Vec3 light_change = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
#endif
  Real weight = C.begin != 0 ? own_weight() : own_steady_weight();
  Real depth = near_depth(0, 0);
  Vec3 normal = turned_there(near_normal(0, 0));
  Vec3 there = near_there(0, 0);
  Bool visible = is_surface(depth) && there.z > 0.0f && there.x > -1.0f && there.y > -1.0f &&
                 there.x < float(F.width) && there.y < float(F.height);
  if (some(visible)) {
    Vec3 position = position_there(there.x, there.y, there.z);
    Real x = there.x;
    Real y = there.y;
    x = select(visible, x, Real(0.0f));
    y = select(visible, y, Real(0.0f));
    Real column = floor(x);
    Real row = floor(y);
    Real right = x - column;
    Real below = y - row;
    Real found = Real(0.0f);
    Real sum = Real(0.0f);
    Real change = Real(0.0f);
    for (int j = 0; j <= 1; ++j)
      for (int i = 0; i <= 1; ++i) {
        Int tap_x = to_int(column) + Int(i);
        Int tap_y = to_int(row) + Int(j);
        Bool inside = tap_x >= Int(0) && tap_y >= Int(0) && tap_x < Int(F.width) && tap_y < Int(F.height);
        Real tap_depth = load_other_depth(tap_x, tap_y);
        Vec3 tap_normal = load_other_normal(tap_x, tap_y);
        Real distance = surface_distance(position, normal, position_there(to_real(tap_x), to_real(tap_y), tap_depth),
                                         tap_normal, C.distance);
        Real fit = same_surface_weight(max(distance, (1.0f - dot(normal, tap_normal)) * Real(C.turn)));
        Real near = (i == 0 ? 1.0f - right : right) * (j == 0 ? 1.0f - below : below);
        near = select(inside && visible && is_finite(fit), near * fit, Real(0.0f));
        Real tap_rays = near * weight_there(tap_x, tap_y);
        found = found + near;
        sum = sum + tap_rays;
        change = mad(tap_rays, clean_ao(load_other_ao(tap_x, tap_y)) - own, change);
#if LIGHT == 1
        light_change = light_change + (clean_light(load_other_indirect(tap_x, tap_y)) - light) * tap_rays;
#endif
      }
    // The frame counts with the mean of its rays where it is found.
    Real scale = clamp(found * (1.0f / kMinFound) - 1.0f, Real(0.0f), Real(1.0f)) / max(found, Real(1e-6f));
    scale = scale * unchanged(px, py);
    Real total = mad(sum, scale, weight);
    Real share = scale / max(total, Real(1e-6f));
    own = mad(change, share, own);
#if LIGHT == 1
    light = light + light_change * share;
#endif
    weight = total;
  }
  store_ao(own);
#if LIGHT == 1
  store_indirect(light);
#endif
  store_steady_weight(weight);
#if RAYS == 1
  store_traced_confidence(weight / (weight + 1.0f));
#endif
}
