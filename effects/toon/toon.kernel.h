// Last dispatch of `toon`: quantizes the intensity into tone steps, antialiases their edges, and colours them. Based
// on [Lajzer and Nottingham], listing 2: floor(4 i)/4 times the object's colour.
//
// Differs in ramp mode: there is a fixed number of tone steps, whose colours range from the shadow's to the light's.
// The steps are averaged over the range of intensity in the pixel, estimated from the differences to its neighbours,
// and shadows have edges of a pixel. Neighbours determine nothing but the widths of edges and highlights; so no colour
// smears over a silhouette.
IN_REAL(depth)
IN_VECTOR(normal)
IN_REAL(toon_key)
IN_REAL(toon_rest)
IN_REAL(toon_visible)
IN_REAL(toon_highlight)
IN_COLOR(albedo)
IN_REAL(specular)
OUT_COLOR(lit)
#include "kernel/surface.kernel.h"

// Max distance of a neighbour's point from the plane of this pixel, in pixel sizes per pixel between the two. Allows
// for curved surfaces.
CONST float kMaxDistancePx = 1.0f;
CONST float kMinEdge = 1e-3f;  // min change of toon_visible across the edge of a shadow
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

// Returns the intensity of the pixel (i, j) to the right and below. `width`: of the edge of a shadow, as a change of
// toon_visible, which is 0.5 at the edge.
FN Real intensity_at(int i, int j, Real width) {
  Real visible = clamp((near_toon_visible(i, j) - 0.5f) / width + 0.5f, Real(0.0f), Real(1.0f));
  return mad(near_toon_key(i, j), mad(visible - 1.0f, Real(C.shadow), Real(1.0f)), near_toon_rest(i, j));
}

// Returns toon_highlight of the pixel (i, j) to the right and below, or a negative value in shadow.
FN Real highlight_at(int i, int j) {
  Real visible = mad(near_toon_visible(i, j) - 1.0f, Real(C.shadow), Real(1.0f));
  return min(near_toon_highlight(i, j), mad(visible, Real(2.0f), Real(-1.0f)));
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
  if (C.mode == kToonPaper) {
    Real visible = mad(near_toon_visible(0, 0) - 1.0f, Real(C.shadow), Real(1.0f));
    Real intensity = mad(near_toon_key(0, 0), visible, near_toon_rest(0, 0));
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

  Real visible = near_toon_visible(0, 0);
  Real across = change(visible, near_toon_visible(-1, 0), near_toon_visible(1, 0), left, right);
  Real along = change(visible, near_toon_visible(0, -1), near_toon_visible(0, 1), up, down);
  Real edge = clamp(sqrt(mad(across, across, along * along)), Real(kMinEdge), Real(1.0f));
  Real intensity = intensity_at(0, 0, edge);
  across = change(intensity, intensity_at(-1, 0, edge), intensity_at(1, 0, edge), left, right);
  along = change(intensity, intensity_at(0, -1, edge), intensity_at(0, 1, edge), up, down);
  Real width = sqrt(mad(across, across, along * along)) * Real(C.steps_per_intensity);
  width = clamp(max(width, Real(C.softness)), Real(C.min_width), Real(1.0f));
  Real scaled = clamp(intensity * C.steps_per_intensity, Real(0.0f), Real(C.steps + 1.0f));
  Real step = clamp(averaged_floor(scaled, width), Real(0.0f), Real(C.steps - 1.0f));
  Vec3 tone = Vec3(mad(step, Real(C.step_r), Real(C.shadow_r)), mad(step, Real(C.step_g), Real(C.shadow_g)),
                   mad(step, Real(C.step_b), Real(C.shadow_b)));
  Vec3 lit = albedo * tone;

  Real highlight = highlight_at(0, 0);
  if (some(highlight > kFarOutside)) {
    Real before = highlight_at(-1, 0);
    Real after = highlight_at(1, 0);
    Real above = highlight_at(0, -1);
    Real below = highlight_at(0, 1);
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
