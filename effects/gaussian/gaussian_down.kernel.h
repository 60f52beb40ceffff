// Filters by [1 2 1]/4 along columns, from `gaussian_ao` to `ao`. Neighbours are clamped to the picture.
IN_REAL(gaussian_ao)
OUT_REAL(ao)
#include "effects/gaussian/gaussian.kernel.h"

FN void gaussian_down_pixel(Int px, Int py) {
  Real before = clean_ao(near_gaussian_ao(0, -1));
  Real own = clean_ao(near_gaussian_ao(0, 0));
  Real after = clean_ao(near_gaussian_ao(0, 1));
  store_ao(blurred(0, 1, px, py, before, own, after));
}
