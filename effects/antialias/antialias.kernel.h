// Third dispatch of `antialias`: mixes the colours of the pixels on both sides of an edge by the areas that they cover.
//
// Mixes the values of the picture as they are displayed, with colour weighted by alpha.
IN_COLOR(antialias_color)
IN_ALPHA(antialias_color)
OUT_COLOR(color)
OUT_ALPHA(color)

#include "effects/antialias/antialias_cover.kernel.h"

FN void antialias_pixel(Int px, Int py) {
  Vec3 own = near_antialias_color(0, 0);
  Real alpha = near_antialias_color_a(0, 0);
  Cover c = cover();
  Bool changes = c.own < 1.0f;
  if (!some(changes)) {
    store_color(own);
    store_color_alpha(alpha);
    return;
  }
  Real left = near_antialias_color_a(-1, 0);
  Real right = near_antialias_color_a(1, 0);
  Real above = near_antialias_color_a(0, -1);
  Real below = near_antialias_color_a(0, 1);
  Real a0 = alpha * c.own;
  Real a1 = left * c.left;
  Real a2 = right * c.right;
  Real a3 = above * c.above;
  Real a4 = below * c.below;
  Real total = a0 + a1 + a2 + a3 + a4;
  Vec3 sum = own * a0 + near_antialias_color(-1, 0) * a1 + near_antialias_color(1, 0) * a2 +
             near_antialias_color(0, -1) * a3 + near_antialias_color(0, 1) * a4;
  Vec3 mixed = sum * (Real(1.0f) / select(total > 0.0f, total, Real(1.0f)));
  store_color(select(changes, mixed, own));
  // Exactly 1 in an opaque picture, where the sum of the weights is rounded.
  Real change =
      mad(left - alpha, c.left, mad(right - alpha, c.right, mad(above - alpha, c.above, (below - alpha) * c.below)));
  store_color_alpha(select(changes, alpha + change, alpha));
}
