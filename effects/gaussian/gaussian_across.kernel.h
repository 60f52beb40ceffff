// Filters by [1 2 1]/4 along rows, from `ao` to `gaussian_ao`. Neighbours are clamped to the picture.
IN_REAL(ao)
OUT_REAL(gaussian_ao)
#include "effects/gaussian/gaussian.kernel.h"

FN void gaussian_across_pixel(Int px, Int py) {
  Real before = clean_ao(near_ao(-1, 0));
  Real own = clean_ao(near_ao(0, 0));
  Real after = clean_ao(near_ao(1, 0));
  store_gaussian_ao(blurred(1, 0, px, py, before, own, after));
}
