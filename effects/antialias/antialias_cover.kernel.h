// Shared by the dispatches of `antialias` that mix: the areas of a pixel that the colours of its neighbours cover.

struct Cover {
  Real left, right, above, below;  // fractions of the pixel that each neighbour's colour covers
  Real own;                        // what remains
};

FN Real square(Real v) { return v * v; }

IN_REAL(antialias_from_left)
IN_REAL(antialias_to_left)
IN_REAL(antialias_from_above)
IN_REAL(antialias_to_above)

FN Cover cover() {
  Real none = Real(0.0f);
  Real left = near_antialias_from_left(0, 0);
  Real above = near_antialias_from_above(0, 0);
  Real right = select(near_inside(1, 0), near_antialias_to_left(1, 0), none);
  Real below = select(near_inside(0, 1), near_antialias_to_above(0, 1), none);
  // At a corner, where edges of both directions meet, the direction that covers more prevails.
  Real weight_across = square(square(left + right));
  Real weight_along = square(square(above + below));
  Real weights = weight_across + weight_along;
  Real scale = Real(1.0f) / select(weights > 0.0f, weights, Real(1.0f));
  left = left * (weight_across * scale);
  right = right * (weight_across * scale);
  above = above * (weight_along * scale);
  below = below * (weight_along * scale);
  return Cover(left, right, above, below, Real(1.0f) - (left + right + above + below));
}
