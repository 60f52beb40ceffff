// What joins ends of the lines that are left, once no crumbs and strays lie between them.
//
// outline_join_left: as outline_stroke.kernel.h has it.
IN_REAL(depth)
IN_VECTOR(normal)
IN_REAL(object_id)
IN_REAL(outline_steep_left)
IN_REAL(outline_flat_left)
OUT_REAL(outline_join_left)
FN Real steep_at(Int x, Int y) { return load_outline_steep_left(x, y); }
FN Real flat_at(Int x, Int y) { return load_outline_flat_left(x, y); }
#include "effects/outline/outline_joined.kernel.h"

FN void outline_rejoin_pixel(Int px, Int py) {
  store_outline_join_left(join_of(px, py, near_outline_steep_left(0, 0), near_outline_flat_left(0, 0)));
}
