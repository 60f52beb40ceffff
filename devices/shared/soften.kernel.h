// Denoising of soft shadows along a row or a column: a mean over pixels that lie on the same surface as the pixel and
// have similar normals.
//
// The first filter averages 4 x 4 pixels, whose rays go to sixteen points on the light. In wide penumbrae sixteen are
// too few: a distant occluder casts sixteen visible edges. There the second filter averages the result of the first one
// again: every fourth pixel, up to `soften_reach` pixels to either side (see soften_reach.kernel.h).
IN_REAL(depth)
IN_VECTOR(normal)
IN_REAL(soften_from)
IN_REAL(soften_reach)
OUT_REAL(soften_to)

#include "kernel/surface.kernel.h"

CONST float kTolerancePx = 1.5f;
CONST float kMinNormalCosine = 0.8f;  // cosine of the angle between the normals

// Returns 1 for the neighbour (i, j) pixels right and down if it is on the same surface, else 0.
FN Real same_surface_weight(int i, int j, Int px, Int py, Vec3 position, Vec3 normal) {
  Vec3 other_position = view_position(px + Int(i), py + Int(j), near_depth(i, j));
  Vec3 other_normal = near_normal(i, j);
  Bool same = surface_distance(position, normal, other_position, other_normal, kTolerancePx) <= 1.0f &&
              dot(other_normal, normal) > kMinNormalCosine;
  return select(same && near_inside(i, j), Real(1.0f), Real(0.0f));
}

FN void soften_pixel(Int px, Int py) {
  Real own = near_soften_from(0, 0);
  Real depth = near_depth(0, 0);
  Vec3 position = view_position(px, py, depth);
  Vec3 normal = near_normal(0, 0);
  // Sums differences, not values: uniform neighbourhoods do not change.
  Real change = Real(0.0f);
  Real weights = Real(1.0f);
  if (C.second == 0) {
    for (int k = -2; k <= 2; ++k) {
      if (k == 0) continue;
      float max_weight = k == -2 || k == 2 ? 0.5f : 1.0f;  // all four positions in a block have the same total weight
      Real weight = same_surface_weight(k * C.dx, k * C.dy, px, py, position, normal) * max_weight;
      change = mad(weight, near_soften_from(k * C.dx, k * C.dy) - own, change);
      weights = weights + weight;
    }
  } else {
    Real reach = block_soften_reach(kSoftenBlock, 0, 0);
    for (int k = 1; k < kSoftenReachBlocks; ++k) {
      // A tap represents four pixels, of which the filter reaches a fraction. The weight is the square of this
      // fraction, since the pixels that are reached are nearer than the tap.
      Real fraction = clamp((reach + kSoftenMin) * 0.25f - float(k), Real(0.0f), Real(1.0f));
      if (some(fraction > 0.0f)) {
        int right = k * kSoftenBlock * C.dx;
        int down = k * kSoftenBlock * C.dy;
        // Takes both neighbours or none: on the slope of a penumbra one alone would shift the mean.
        Real weight = fraction * fraction * same_surface_weight(-right, -down, px, py, position, normal) *
                      same_surface_weight(right, down, px, py, position, normal);
        change = mad(weight, near_soften_from(-right, -down) - own + (near_soften_from(right, down) - own), change);
        weights = mad(weight, Real(2.0f), weights);
      }
    }
  }
  store_soften_to(select(is_surface(depth), own + change / weights, own));
}
