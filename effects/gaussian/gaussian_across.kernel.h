// [1 2 1]/4 along rows, from `ao` to `gaussian_ao`. The picture's border is clamped.
IN_REAL(ao)
OUT_REAL(gaussian_ao)
#include "effects/gaussian/gaussian.kernel.h"

FN void gaussian_across_pixel(Int px, Int py) {
  Real before = clean_ao(near_ao(-1, 0));
  Real own = clean_ao(near_ao(0, 0));
  Real after = clean_ao(near_ao(1, 0));
  Real weight_before = Real(1.0f);
  Real weight_after = Real(1.0f);
  if (C.edges != 0) {
    Vec3 position = view_position(px, py, near_depth(0, 0));
    Vec3 normal = near_normal(0, 0);
    weight_before = belongs(-1, 0, px, py, position, normal);
    weight_after = belongs(1, 0, px, py, position, normal);
  }
  store_gaussian_ao(joined(before, own, after, weight_before, weight_after));
}
