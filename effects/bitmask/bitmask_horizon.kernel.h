// Occlusion only, by occluders of infinite thickness. On each side of a slice, the highest occluder covers all
// directions below it, so that one measurement per side suffices. Based on [Jimenez et al. 2016], Algorithm 1 and
// equation 7; the measure is that of bitmask_measure.kernel.h.
// KERNEL bitmask_horizon: LAYERS=0 BENT=0 LIGHT=0
#include "effects/bitmask/bitmask.kernel.h"

// Returns the larger of `highest` and the cosine to the surface at a tap, which approaches side.low towards the radius
// if C.falloff is above 0.
FN Real raised_horizon(Real highest, Side side, TapVector to_tap, Real depth) {
  Real c = cosine_of(to_tap);
  if (C.falloff > 0.0f) {
    Real distance = to_tap.squared * rsqrt(to_tap.squared);
    Real fraction = clamp((Real(C.radius) - distance) * Real(C.fade), Real(0.0f), Real(1.0f));
    c = mad(c - side.low, fraction, side.low);
  }
  return select(is_near(to_tap, depth), max(c, highest), highest);
}

// Returns the measure, on one side, of the directions from the view direction down to the cosine c. `nv`, `nt`:
// components of the normal along the view direction and along the side.
FN Real unoccluded_measure(Real c, Real nv, Real nt) {
  return mad(nv, mad(-c, c, Real(1.0f)), nt * (Real(1.57079633f) - arc(c)));
}

FN Real visibility_at(Int px, Int py, Real depth) {
  ShadedPoint point = shaded_point_at(px, py, depth);
  Vec3 noise = noise_at(px, py);
  Vec2 direction = direction_of(noise.x);
  Real open_sum = Real(0.0f);
  Real weight_sum = Real(0.0f);
  for (int s = 0; s < C.slices; ++s) {
    Slice slice = slice_of(direction.x, direction.y, point.eye, point.normal, point.facing, Real(0.0f));
    Real jitter = fract(mad(Real(float(s)), Real(kStepTurn), noise.y));
    Real above = slice.above.low;
    Real below = slice.below.low;
    Real inside_above = Real(0.0f);
    Real inside_below = Real(0.0f);
    for (int k = 0; k < C.steps; ++k) {
      Real distance_px =
          mad(step_length((jitter + float(k)) * Real(C.one_over_steps)), point.radius_px, Real(kFirstStep));
      Real size = mip_size(distance_px);
      Tap tap = tap_at(point.from, slice.above, distance_px, size, point.near_border);
      Real tap_depth = select(tap.inside, tap.depth, Real(0.0f));
      above = raised_horizon(above, slice.above, vector_to_tap(point.from, slice.above, tap.x, tap.y, tap_depth),
                             tap_depth);
      if (point.near_border) inside_above = inside_above + select(tap.inside, Real(1.0f), Real(0.0f));
      tap = tap_at(point.from, slice.below, distance_px, size, point.near_border);
      tap_depth = select(tap.inside, tap.depth, Real(0.0f));
      below = raised_horizon(below, slice.below, vector_to_tap(point.from, slice.below, tap.x, tap.y, tap_depth),
                             tap_depth);
      if (point.near_border) inside_below = inside_below + select(tap.inside, Real(1.0f), Real(0.0f));
    }
    Real nt = slice.sn * slice.projected;
    Real fraction_above = Real(1.0f);
    Real fraction_below = Real(1.0f);
    if (point.near_border && C.skip_outside != 0) {
      fraction_above = inside_above * Real(C.one_over_steps);
      fraction_below = inside_below * Real(C.one_over_steps);
    }
    open_sum = mad(unoccluded_measure(above, point.facing, nt), fraction_above,
                   mad(unoccluded_measure(below, point.facing, -nt), fraction_below, open_sum));
    weight_sum = mad(unoccluded_measure(slice.above.low, point.facing, nt), fraction_above,
                     mad(unoccluded_measure(slice.below.low, point.facing, -nt), fraction_below, weight_sum));
    direction = Vec2(mad(direction.x, Real(C.turn_cos), direction.y * -C.turn_sin),
                     mad(direction.y, Real(C.turn_cos), direction.x * C.turn_sin));
  }
  Real divisor = max(weight_sum, Real(1e-6f));
  return select(weight_sum > 1e-6f, min(open_sum / divisor, Real(1.0f)), Real(1.0f));
}

#include "kernel/occlusion.kernel.h"

FN void bitmask_horizon_pixel(Int px, Int py) { store_visibility(px, py); }
