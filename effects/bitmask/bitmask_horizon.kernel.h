// Occlusion only, by occluders of infinite thickness: on each side of a slice, the highest occluder hides all
// directions below it, so that one measurement per side suffices. Based on [Jimenez et al. 2016], Algorithm 1 and
// equation 7; arcs as in bitmask_measure.kernel.h.
#include "effects/bitmask/bitmask_no_light.kernel.h"
#include "effects/bitmask/bitmask_not_bent.kernel.h"
#include "effects/bitmask/bitmask_one_layer.kernel.h"

#include "effects/bitmask/bitmask.kernel.h"

// Returns the larger of `highest` and the cosine of the surface at a tap, faded by C.falloff.
FN Real higher_of(Real highest, Side side, Way way, Real depth) {
  Real c = cosine_of(way);
  if (C.falloff > 0.0f) {
    Real distance = way.squared * rsqrt(way.squared);
    Real fraction = clamp((Real(C.radius) - distance) * Real(C.fade), Real(0.0f), Real(1.0f));
    c = mad(c - side.low, fraction, side.low);
  }
  return select(is_near(way, depth), max(c, highest), highest);
}

// Returns the measure of the directions of one side from the view direction down to the cosine c.
FN Real unoccluded_measure(Real c, Real nv, Real nt) {
  return mad(nv, mad(-c, c, Real(1.0f)), nt * (Real(1.57079633f) - arc(c)));
}

FN Real visibility_at(Int px, Int py, Real depth) {
  Seen seen = shaded_point_at(px, py, depth);
  Vec3 noise = noise_at(px, py);
  Vec2 direction = direction_of(noise.x);
  Real open_sum = Real(0.0f);
  Real whole_sum = Real(0.0f);
  for (int s = 0; s < C.slices; ++s) {
    Slice slice = slice_of(direction.x, direction.y, seen.eye, seen.normal, seen.facing, Real(0.0f));
    Real jitter = fract(mad(Real(float(s)), Real(kStepTurn), noise.y));
    Real above = slice.above.low;
    Real below = slice.below.low;
    Real inside_above = Real(0.0f);
    Real inside_below = Real(0.0f);
    for (int k = 0; k < C.steps; ++k) {
      Real off = mad(step_length((jitter + float(k)) * Real(C.one_over_steps)), seen.reach, Real(kFirstStep));
      Real size = mip_size(off);
      Tap tap = tap_at(seen.from, slice.above, off, size, seen.near_border);
      Real shown = select(tap.inside, tap.depth, Real(0.0f));
      above = higher_of(above, slice.above, vector_to_tap(seen.from, slice.above, tap.x, tap.y, shown), shown);
      if (seen.near_border) inside_above = inside_above + select(tap.inside, Real(1.0f), Real(0.0f));
      tap = tap_at(seen.from, slice.below, off, size, seen.near_border);
      shown = select(tap.inside, tap.depth, Real(0.0f));
      below = higher_of(below, slice.below, vector_to_tap(seen.from, slice.below, tap.x, tap.y, shown), shown);
      if (seen.near_border) inside_below = inside_below + select(tap.inside, Real(1.0f), Real(0.0f));
    }
    Real nt = slice.sn * slice.projected;
    Real share_above = Real(1.0f);
    Real share_below = Real(1.0f);
    if (seen.near_border && C.skip_outside != 0) {
      share_above = inside_above * Real(C.one_over_steps);
      share_below = inside_below * Real(C.one_over_steps);
    }
    open_sum = mad(unoccluded_measure(above, seen.facing, nt), share_above,
                   mad(unoccluded_measure(below, seen.facing, -nt), share_below, open_sum));
    whole_sum = mad(unoccluded_measure(slice.above.low, seen.facing, nt), share_above,
                    mad(unoccluded_measure(slice.below.low, seen.facing, -nt), share_below, whole_sum));
    direction = Vec2(mad(direction.x, Real(C.turn_cos), direction.y * -C.turn_sin),
                     mad(direction.y, Real(C.turn_cos), direction.x * C.turn_sin));
  }
  Real known = max(whole_sum, Real(1e-6f));
  return select(whole_sum > 1e-6f, min(open_sum / known, Real(1.0f)), Real(1.0f));
}

#include "kernel/occlusion.kernel.h"

FN void bitmask_horizon_pixel(Int px, Int py) { store_visibility(px, py); }
