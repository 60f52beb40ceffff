// First dispatch of `antialias`: finds the edges of the finished picture. Based on the edge detection of
// [Jimenez et al. 2012].
//
// `antialias_edge_left` is the strength of the edge between this pixel and the one to its left, `antialias_edge_above`
// of that to the one above: 0 where there is none, 1 where it is clear. `antialias_color` is a copy of the picture,
// which the third dispatch overwrites.
//
// Differs: edges have a strength instead of a flag. So a small change of the picture never changes the result much.
IN_COLOR(color)
IN_ALPHA(color)
OUT_REAL(antialias_edge_left)
OUT_REAL(antialias_edge_above)
OUT_COLOR(antialias_color)
OUT_ALPHA(antialias_color)

// An edge has no strength if another edge of the same pixel has this many times its contrast: a soft shadow beside a
// silhouette is not a second edge.
CONST float kMaxContrastRatio = 2.0f;

// Returns the largest difference between channels of two neighbours of this pixel; colour is weighted by alpha.
FN Real contrast(int i, int j, int k, int l) {
  Real a = near_color_a(i, j);
  Real b = near_color_a(k, l);
  Vec3 difference = near_color(i, j) * a - near_color(k, l) * b;
  return max(max(abs(difference.x), abs(difference.y)), max(abs(difference.z), abs(a - b)));
}

// Returns the strength of an edge: 0 up to the contrast `weakest`, 1 from twice this.
FN Real strength_of(Real of_edge, Real weakest) { return clamp(of_edge / weakest - 1.0f, Real(0.0f), Real(1.0f)); }

FN void antialias_edges_pixel(Int px, Int py) {
  store_antialias_color(near_color(0, 0));
  store_antialias_color_alpha(near_color_a(0, 0));
  Real left = contrast(0, 0, -1, 0);
  Real above = contrast(0, 0, 0, -1);
  if (!some(max(left, above) > C.threshold)) {
    store_antialias_edge_left(Real(0.0f));
    store_antialias_edge_above(Real(0.0f));
    return;
  }
  Real others = max(max(contrast(0, 0, 1, 0), contrast(0, 0, 0, 1)), max(left, above));
  others = max(others, max(contrast(-1, 0, -2, 0), contrast(0, -1, 0, -2)));
  Real weakest = max(others * (1.0f / kMaxContrastRatio), Real(C.threshold));
  store_antialias_edge_left(strength_of(left, weakest));
  store_antialias_edge_above(strength_of(above, weakest));
}
