// [1 2 1]/4 along columns, from `gaussian_ao` back to `ao`. The picture's border is clamped.
IN_REAL(gaussian_ao)
OUT_REAL(ao)
#include "effects/gaussian/gaussian.kernel.h"

FN void gaussian_down_pixel(Int px, Int py) {
  Real before = clean_ao(near_gaussian_ao(0, -1));
  Real own = clean_ao(near_gaussian_ao(0, 0));
  Real after = clean_ao(near_gaussian_ao(0, 1));
  Real weight_before = Real(1.0f);
  Real weight_after = Real(1.0f);
  if (C.edges != 0) {
    Vec3 position = view_position(px, py, near_depth(0, 0));
    Vec3 normal = near_normal(0, 0);
    weight_before = belongs(0, -1, px, py, position, normal);
    weight_after = belongs(0, 1, px, py, position, normal);
  }
  store_ao(joined(before, own, after, weight_before, weight_after));
}
