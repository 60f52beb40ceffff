// Last dispatch of `antialias`: mixes the colours of the pixels on both sides of an edge by the areas that they cover.
//
// Mixes the values of the picture as they are displayed, with colour weighted by alpha.
IN_COLOR(antialias_color)
IN_ALPHA(antialias_color)
IN_REAL(antialias_from_left)
IN_REAL(antialias_to_left)
IN_REAL(antialias_from_above)
IN_REAL(antialias_to_above)
OUT_COLOR(color)
OUT_ALPHA(color)

FN Real square(Real v) { return v * v; }

FN void antialias_pixel(Int px, Int py) {
  Vec3 own = near_antialias_color(0, 0);
  Real alpha = near_antialias_color_a(0, 0);
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
  Bool changes = left + right + above + below > 0.0f;
  if (!some(changes)) {
    store_color(own);
    store_color_alpha(alpha);
    return;
  }
  Real rest = Real(1.0f) - (left + right + above + below);
  Real a0 = alpha * rest;
  Real a1 = near_antialias_color_a(-1, 0) * left;
  Real a2 = near_antialias_color_a(1, 0) * right;
  Real a3 = near_antialias_color_a(0, -1) * above;
  Real a4 = near_antialias_color_a(0, 1) * below;
  Real total = a0 + a1 + a2 + a3 + a4;
  Vec3 sum = own * a0 + near_antialias_color(-1, 0) * a1 + near_antialias_color(1, 0) * a2 +
             near_antialias_color(0, -1) * a3 + near_antialias_color(0, 1) * a4;
  Vec3 mixed = sum * (Real(1.0f) / select(total > 0.0f, total, Real(1.0f)));
  store_color(select(changes, mixed, own));
  store_color_alpha(select(changes, total, alpha));
}
