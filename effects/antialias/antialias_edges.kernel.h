// First dispatch of `antialias`: finds the edges of the finished picture. Based on the edge detection of
// [Jimenez et al. 2012].
//
// `antialias_edges` is 1 if there is an edge between this pixel and the one to its left, 2 if there is one between this
// pixel and the one above, 3 if both. `antialias_color` is a copy of the picture, which the last dispatch overwrites.
IN_COLOR(color)
IN_ALPHA(color)
OUT_REAL(antialias_edges)
OUT_COLOR(antialias_color)
OUT_ALPHA(antialias_color)

// An edge is dropped if another edge of the same pixel has more than this many times its contrast: a soft shadow beside
// a silhouette is not a second edge.
CONST float kMaxContrastRatio = 2.0f;

// Returns the largest difference between channels of two neighbours of this pixel; colour is weighted by alpha.
FN Real contrast(int i, int j, int k, int l) {
  Real a = near_color_a(i, j);
  Real b = near_color_a(k, l);
  Vec3 difference = near_color(i, j) * a - near_color(k, l) * b;
  return max(max(abs(difference.x), abs(difference.y)), max(abs(difference.z), abs(a - b)));
}

FN void antialias_edges_pixel(Int px, Int py) {
  store_antialias_color(near_color(0, 0));
  store_antialias_color_alpha(near_color_a(0, 0));
  Real left = contrast(0, 0, -1, 0);
  Real above = contrast(0, 0, 0, -1);
  Bool candidate = max(left, above) >= C.threshold;
  if (!some(candidate)) {
    store_antialias_edges(Real(0.0f));
    return;
  }
  Real others = max(max(contrast(0, 0, 1, 0), contrast(0, 0, 0, 1)), max(left, above));
  others = max(others, max(contrast(-1, 0, -2, 0), contrast(0, -1, 0, -2)));
  Real weakest = max(others * (1.0f / kMaxContrastRatio), Real(C.threshold));
  store_antialias_edges(select(left >= weakest, Real(1.0f), Real(0.0f)) +
                        select(above >= weakest, Real(2.0f), Real(0.0f)));
}
