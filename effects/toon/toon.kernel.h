// Second pass of `toon`: cuts the intensity into bands, antialiases their edges, and colours them.
// Based on [Lajzer and Nottingham], listing 2: floor(4 i)/4 times the object's colour.
//
// Differs in ramp mode: a fixed number of bands, coloured from the shadow's colour to the light's. The step from band
// to band is averaged over the range of intensity that the pixel covers, which comes from the differences to its
// neighbours. They tell a width, and whether a highlight is narrower than a pixel, and nothing else: no neighbour's
// light or colour enters, so nothing smears over a silhouette.
IN_REAL(depth)
IN_REAL(toon_intensity)
IN_REAL(toon_highlight)
IN_COLOR(albedo)
IN_REAL(specular)
OUT_COLOR(lit)

// Neighbours whose depths differ by more, as a share of the nearer one, lie on two surfaces.
CONST float kDepthJump = 0.1f;
// A highlight's plane below this is outside, however blurred its edge.
CONST float kFarOutside = -0.5f;

// Whether the neighbour lies on the same surface.
FN Bool connected(Real depth, Real other, Bool inside) {
  return inside && abs(other - depth) <= min(depth, other) * kDepthJump;
}

// How much a value changes across a pixel along one axis, from its neighbours on the same surface. The mean of both
// differences, but at most twice the smaller: at a crease or a shadow's edge one side belongs to another surface's
// light.
FN Real change(Real centre, Real before, Real after, Bool has_before, Bool has_after) {
  Real a = abs(before - centre);
  Real b = abs(after - centre);
  a = select(has_before, a, select(has_after, b, Real(0.0f)));
  b = select(has_after, b, a);
  return min((a + b) * 0.5f, min(a, b) * 2.0f);
}

// floor(t) averaged over [t - width/2, t + width/2], width in (0, 1].
FN Real averaged_floor(Real t, Real width) {
  Real high = mad(width, Real(0.5f), t);
  Real edge = floor(high);
  return edge - 1.0f + min((high - edge) / width, Real(1.0f));
}

// The band of an intensity.
FN Real band_of(Real intensity) {
  return clamp(floor(intensity * C.bands_per_intensity), Real(0.0f), Real(C.bands - 1.0f));
}

// What a frame around a pixel, C.speck pixels away, has of its surface.
struct Frame {
  Bool whole;        // all of it is in one band
  Real least, most;  // of its intensities
};

FN_RARE Frame frame_of(Bool asked, Real depth, Real band) {
  Frame frame = Frame(asked, Real(1e30f), Real(-1e30f));
  for (int k = 0; k < 8 * C.speck; ++k) {
    if (!some(frame.whole)) continue;
    // Its four sides by turns.
    int m = k / 4 - C.speck;
    int i = k % 4 == 0 ? m : k % 4 == 1 ? -m : k % 4 == 2 ? C.speck : -C.speck;
    int j = k % 4 == 0 ? -C.speck : k % 4 == 1 ? C.speck : k % 4 == 2 ? m : -m;
    Real intensity = near_toon_intensity(i, j);
    frame.least = min(frame.least, intensity);
    frame.most = max(frame.most, intensity);
    Bool here = connected(depth, near_depth(i, j), near_inside(i, j));
    frame.whole = frame.whole && here && band_of(intensity) == band;
  }
  return frame;
}

// Whether all that is of other bands within the frame is at most C.speck pixels wide and high. Each pixel of it sees
// the same then, so that it is there or not as a whole; what is wider touches the frames of those at its border.
FN_RARE Bool is_speck(Bool asked, Real band) {
  int most = C.speck - 1;
  Real left = Real(float(C.speck));
  Real right = Real(float(-C.speck));
  Real top = left;
  Real bottom = right;
  for (int j = -most; j <= most; ++j)
    for (int i = -most; i <= most; ++i) {
      Bool other = !(band_of(near_toon_intensity(i, j)) == band);
      left = select(other, min(left, Real(float(i))), left);
      right = select(other, max(right, Real(float(i))), right);
      top = select(other, min(top, Real(float(j))), top);
      bottom = select(other, max(bottom, Real(float(j))), bottom);
    }
  Real widest = Real(float(C.speck));
  return asked && right - left < widest && bottom - top < widest;
}

// How far a highlight reaches along one axis within a pixel that it ends in on either side: its plane changes evenly
// up to both neighbours. 1 where it does not end on both sides.
FN Real reach_along(Real centre, Real before, Real after, Bool has_before, Bool has_after) {
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
    Vec3 lit = albedo * (max(floor(intensity * C.bands), Real(0.0f)) * Real(C.inverse_bands));
    store_lit(select(surface, finite_or_zero(lit), none));
    return;
  }
  Bool left = connected(depth, near_depth(-1, 0), near_inside(-1, 0));
  Bool right = connected(depth, near_depth(1, 0), near_inside(1, 0));
  Bool up = connected(depth, near_depth(0, -1), near_inside(0, -1));
  Bool down = connected(depth, near_depth(0, 1), near_inside(0, 1));

  Real across = change(intensity, near_toon_intensity(-1, 0), near_toon_intensity(1, 0), left, right);
  Real along = change(intensity, near_toon_intensity(0, -1), near_toon_intensity(0, 1), up, down);
  Real width = sqrt(mad(across, across, along * along)) * Real(C.bands_per_intensity);
  width = clamp(max(width, Real(C.softness)), Real(C.least_width), Real(1.0f));
  Real scaled = clamp(intensity * C.bands_per_intensity, Real(0.0f), Real(C.bands + 1.0f));
  Real band = clamp(averaged_floor(scaled, width), Real(0.0f), Real(C.bands - 1.0f));
  // A speck is of the band that is all around it.
  if (C.speck > 0) {
    Real beyond = band_of(near_toon_intensity(C.speck, 0));
    Bool speck = surface && !(band == beyond);
    if (some(speck)) {
      Frame frame = frame_of(speck, depth, beyond);
      speck = frame.whole;
      if (some(speck)) speck = is_speck(speck, beyond);
      Real within = clamp(scaled, frame.least * C.bands_per_intensity, frame.most * C.bands_per_intensity);
      Real even = clamp(Real(C.softness), Real(C.least_width), Real(1.0f));
      within = clamp(averaged_floor(within, even), Real(0.0f), Real(C.bands - 1.0f));
      band = select(speck, within, band);
    }
  }
  Vec3 tone = Vec3(mad(band, Real(C.step_r), Real(C.shadow_r)), mad(band, Real(C.step_g), Real(C.shadow_g)),
                   mad(band, Real(C.step_b), Real(C.shadow_b)));
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
    Real narrow = clamp(width - 1.0f, Real(0.0f), Real(1.0f));
    width = clamp(max(width, Real(C.softness)), Real(C.least_width), Real(1.0f));
    Real inside = clamp(highlight / width + 0.5f, Real(0.0f), Real(1.0f));
    // One that is narrower than a pixel, as on a bevel, covers no more of it than it is wide, and nothing of one that
    // it does not reach: else it is a row of dots.
    Real most = min(reach_along(highlight, before, after, left, right), reach_along(highlight, above, below, up, down));
    Bool reached = highlight > 0.0f || (left && before > 0.0f) || (right && after > 0.0f) || (up && above > 0.0f) ||
                   (down && below > 0.0f);
    inside = inside + (min(inside, select(reached, most, Real(0.0f))) - inside) * narrow;
    // The material's root: between 0.05 and 0.5, where materials lie, highlights stay visible and differ.
    Real strength = sqrt(clamp(near_specular(0, 0), Real(0.0f), Real(1.0f))) * Real(C.specular);
    Real share = inside * min(strength, Real(1.0f));
    lit = lit + (Vec3(Real(C.light_r), Real(C.light_g), Real(C.light_b)) - lit) * share;
  }
  store_lit(select(surface, finite_or_zero(lit), none));
}
