// Second dispatch of `toon`: quantizes the intensity into tone steps, antialiases their edges, and colours them. Based
// on [Lajzer and Nottingham], listing 2: floor(4 i)/4 times the object's colour.
//
// Differs in ramp mode: there is a fixed number of tone steps, whose colours range from the shadow's to the light's.
// The steps are averaged over the range of intensity in the pixel, estimated from the differences to its neighbours. A
// speck (a group of few pixels) gets the tone step of the pixels around it on the same surface. Neighbours determine
// nothing but this and the widths of edges and highlights; so no colour smears over a silhouette.
IN_REAL(depth)
IN_VECTOR(normal)
IN_REAL(toon_intensity)
IN_REAL(toon_highlight)
IN_COLOR(albedo)
IN_REAL(specular)
OUT_COLOR(lit)
#include "kernel/surface.kernel.h"

// Max distance of a neighbour's point from the plane of this pixel, in pixel sizes per pixel between the two. Allows
// for curved surfaces.
CONST float kMaxDistancePx = 1.0f;
// A pixel with a toon_highlight below this is outside the highlight even if the edge has its max width.
CONST float kFarOutside = -0.5f;

// Returns whether the pixel i columns right and j rows down shows the same surface as this one.
FN Bool on_same_surface(int i, int j, Int px, Int py, Vec3 position, Vec3 normal) {
  int across = i < 0 ? -i : i;
  int along = j < 0 ? -j : j;
  float away = float(across > along ? across : along);
  Vec3 there = view_position(px + Int(i), py + Int(j), near_depth(i, j));
  return near_inside(i, j) &&
         surface_distance(position, normal, there, near_normal(i, j), kMaxDistancePx * away) <= 1.0f;
}

// Returns the change of a value across this pixel along one axis, from its neighbours on the same surface: the mean of
// the two differences, but at most twice the smaller one, since at a crease or at the edge of a shadow the larger
// difference does not occur within this pixel.
FN Real change(Real centre, Real before, Real after, Bool has_before, Bool has_after) {
  Real a = abs(before - centre);
  Real b = abs(after - centre);
  a = select(has_before, a, select(has_after, b, Real(0.0f)));
  b = select(has_after, b, a);
  return min((a + b) * 0.5f, min(a, b) * 2.0f);
}

// Returns floor(t) averaged over [t - width/2, t + width/2], width in (0, 1].
FN Real averaged_floor(Real t, Real width) {
  Real high = mad(width, Real(0.5f), t);
  Real edge = floor(high);
  return edge - 1.0f + min((high - edge) / width, Real(1.0f));
}

// Returns the tone step of an intensity.
FN Real step_of(Real intensity) {
  return clamp(floor(intensity * C.steps_per_intensity), Real(0.0f), Real(C.steps - 1.0f));
}

FN Bool has_step(Real step, int i, int j) { return step_of(near_toon_intensity(i, j)) == step; }

// Returns whether any of the next C.speck pixels in one direction has another tone step than `step`; false where
// `enabled` is not set.
FN Bool has_other_step(Bool enabled, Real step, int right, int down) {
  Bool found = Bool(false);
  for (int k = 1; k <= C.speck; ++k)
    if (some(enabled && !found)) found = found || (enabled && !has_step(step, k * right, k * down));
  return found;
}

// Returns whether the next pixel in one direction has another tone step than `step` and any pixel after it, up to
// C.speck away, has `step` again; false where `enabled` is not set.
FN Bool has_narrow_other(Bool enabled, Real step, int right, int down) {
  Bool other = enabled && !has_step(step, right, down);
  Bool found = Bool(false);
  for (int k = 2; k <= C.speck; ++k)
    if (some(other && !found)) found = found || (other && has_step(step, k * right, k * down));
  return found;
}

// Returns whether this pixel may be in a speck or at the antialiased edge of one. This test is cheap, and false for
// most pixels.
FN Bool may_be_speck(Bool surface, Real intensity, Real antialiased) {
  Real step = step_of(intensity);
  Bool within = has_other_step(surface, step, 1, 0);
  if (some(within)) within = has_other_step(within, step, -1, 0);
  if (some(within)) within = has_other_step(within, step, 0, 1);
  if (some(within)) within = has_other_step(within, step, 0, -1);
  Bool edge = surface && !within && !(antialiased == step);
  Bool beside = Bool(false);
  if (some(edge)) {
    beside = has_narrow_other(edge, step, 1, 0) || has_narrow_other(edge, step, -1, 0) ||
             has_narrow_other(edge, step, 0, 1) || has_narrow_other(edge, step, 0, -1);
  }
  return within || beside;
}

// A square ring of pixels around this one that all have one tone step.
struct Ring {
  Bool found;
  Real min, max;  // of the intensity of its pixels
};

// Returns the first ring that shows this pixel's surface and has one tone step, of the rings around all squares of
// C.speck x C.speck pixels that contain this pixel. If a speck fits into such a square, this finds a ring for each of
// its pixels; so a speck is either removed entirely or not at all.
FN_RARE Ring ring_around(Bool enabled, Int px, Int py, Vec3 position, Vec3 normal) {
  Ring result = Ring(Bool(false), Real(0.0f), Real(0.0f));
  int side = C.speck + 1;
  for (int at = 0; at < C.speck * C.speck; ++at) {
    Ring ring = Ring(enabled && !result.found, Real(1e30f), Real(-1e30f));
    if (!some(ring.found)) continue;
    int left = -1 - at % C.speck;
    int top = -1 - at / C.speck;
    Real step = step_of(near_toon_intensity(left, top));
    for (int k = 0; k < 4 * side; ++k) {
      if (!some(ring.found)) continue;
      // k % 4 selects the side of the ring, m the pixel of that side.
      int m = k / 4;
      int i = k % 4 == 0 ? left + m : k % 4 == 1 ? left + side - m : k % 4 == 2 ? left + side : left;
      int j = k % 4 == 0 ? top : k % 4 == 1 ? top + side : k % 4 == 2 ? top + m : top + side - m;
      Real intensity = near_toon_intensity(i, j);
      ring.min = min(ring.min, intensity);
      ring.max = max(ring.max, intensity);
      Bool here = on_same_surface(i, j, px, py, position, normal);
      ring.found = ring.found && here && step_of(intensity) == step;
    }
    result.min = select(ring.found, ring.min, result.min);
    result.max = select(ring.found, ring.max, result.max);
    result.found = result.found || ring.found;
  }
  return result;
}

// Returns the extent of a highlight along one axis, 0 to 1 pixel, if this pixel is inside it and both neighbours on
// this surface are outside; else 1. toon_highlight is interpolated linearly between the pixels.
FN Real extent_along(Real centre, Real before, Real after, Bool has_before, Bool has_after) {
  Bool ends = centre > 0.0f && has_before && has_after && before < 0.0f && after < 0.0f;
  Real backward = min(centre / max(centre - before, Real(1e-20f)), Real(0.5f));
  Real forward = min(centre / max(centre - after, Real(1e-20f)), Real(0.5f));
  return select(ends, backward + forward, Real(1.0f));
}

FN void toon_pixel(Int px, Int py) {
  Vec3 none = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  Real depth = near_depth(0, 0);
  Bool surface = is_finite(depth);
  if (!some(surface)) {
    store_lit(none);
    return;
  }
  Vec3 albedo = Vec3(Real(1.0f), Real(1.0f), Real(1.0f));
  if (C.albedo != kToonClay) albedo = near_albedo(0, 0);
  if (C.albedo == kToonDisplay) albedo = display_from_linear(albedo);
  Real intensity = near_toon_intensity(0, 0);
  if (C.mode == kToonPaper) {
    Vec3 lit = albedo * (max(floor(intensity * C.steps), Real(0.0f)) * Real(C.inverse_steps));
    store_lit(select(surface, finite_or_zero(lit), none));
    return;
  }
  Vec3 position = view_position(px, py, depth);
  Vec3 normal = near_normal(0, 0);
  Bool left = on_same_surface(-1, 0, px, py, position, normal);
  Bool right = on_same_surface(1, 0, px, py, position, normal);
  Bool up = on_same_surface(0, -1, px, py, position, normal);
  Bool down = on_same_surface(0, 1, px, py, position, normal);

  Real across = change(intensity, near_toon_intensity(-1, 0), near_toon_intensity(1, 0), left, right);
  Real along = change(intensity, near_toon_intensity(0, -1), near_toon_intensity(0, 1), up, down);
  Real width = sqrt(mad(across, across, along * along)) * Real(C.steps_per_intensity);
  width = clamp(max(width, Real(C.softness)), Real(C.min_width), Real(1.0f));
  Real scaled = clamp(intensity * C.steps_per_intensity, Real(0.0f), Real(C.steps + 1.0f));
  Real step = clamp(averaged_floor(scaled, width), Real(0.0f), Real(C.steps - 1.0f));
  // A speck takes the tone step that surrounds it.
  if (C.speck > 0) {
    Bool candidate = may_be_speck(surface, intensity, step);
    if (some(candidate)) {
      Ring ring = ring_around(candidate, px, py, position, normal);
      Real within = clamp(scaled, ring.min * C.steps_per_intensity, ring.max * C.steps_per_intensity);
      within = averaged_floor(min(within, Real(C.steps + 1.0f)), Real(C.min_width));
      step = select(ring.found, clamp(within, Real(0.0f), Real(C.steps - 1.0f)), step);
    }
  }
  Vec3 tone = Vec3(mad(step, Real(C.step_r), Real(C.shadow_r)), mad(step, Real(C.step_g), Real(C.shadow_g)),
                   mad(step, Real(C.step_b), Real(C.shadow_b)));
  Vec3 lit = albedo * tone;

  Real highlight = near_toon_highlight(0, 0);
  if (some(highlight > kFarOutside)) {
    Real before = near_toon_highlight(-1, 0);
    Real after = near_toon_highlight(1, 0);
    Real above = near_toon_highlight(0, -1);
    Real below = near_toon_highlight(0, 1);
    across = change(highlight, before, after, left, right);
    along = change(highlight, above, below, up, down);
    width = sqrt(mad(across, across, along * along));
    Real thinness = clamp(width - 1.0f, Real(0.0f), Real(1.0f));
    width = clamp(max(width, Real(C.softness)), Real(C.min_width), Real(1.0f));
    Real inside = clamp(highlight / width + 0.5f, Real(0.0f), Real(1.0f));
    // A highlight narrower than a pixel, such as on a bevel, covers at most its width in pixels of this pixel, and
    // nothing of a pixel that it does not reach. Without these limits it would be a row of dots.
    Real max_value =
        min(extent_along(highlight, before, after, left, right), extent_along(highlight, above, below, up, down));
    Bool reached = highlight > 0.0f || (left && before > 0.0f) || (right && after > 0.0f) || (up && above > 0.0f) ||
                   (down && below > 0.0f);
    inside = inside + (min(inside, select(reached, max_value, Real(0.0f))) - inside) * thinness;
    // Uses the square root of the material's specular value, so that typical values, 0.05 to 0.5, give highlights that
    // are visible and still differ.
    Real strength = sqrt(clamp(near_specular(0, 0), Real(0.0f), Real(1.0f))) * Real(C.specular);
    Real fraction = inside * min(strength, Real(1.0f));
    lit = lit + (Vec3(Real(C.light_r), Real(C.light_g), Real(C.light_b)) - lit) * fraction;
  }
  store_lit(select(surface, finite_or_zero(lit), none));
}
