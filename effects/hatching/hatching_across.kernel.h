// Fourth dispatch of `hatching`: filters directions along rows, from `hatching_raw` to `hatching_row`.
IN_REAL(hatching_raw_x)
IN_REAL(hatching_raw_y)
OUT_REAL(hatching_row_x)
OUT_REAL(hatching_row_y)

CONST bool kAlongRows = true;
FN Vec2 direction_at(int i, int j) { return Vec2(near_hatching_raw_x(i, j), near_hatching_raw_y(i, j)); }
#include "effects/hatching/hatching_filter.kernel.h"

FN void hatching_across_pixel(Int px, Int py) {
  Vec2 sum = filtered(px, py);
  store_hatching_row_x(sum.x);
  store_hatching_row_y(sum.y);
}
