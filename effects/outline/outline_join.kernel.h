// What joins ends of lines, for outline_strays to know what leads to nothing.
//
// outline_join: as outline_stroke.kernel.h has it.
IN_REAL(depth)
IN_VECTOR(normal)
IN_REAL(object_id)
IN_REAL(outline_steep_trimmed)
IN_REAL(outline_flat_trimmed)
OUT_REAL(outline_join)
FN Real steep_at(Int x, Int y) { return load_outline_steep_trimmed(x, y); }
FN Real flat_at(Int x, Int y) { return load_outline_flat_trimmed(x, y); }
#include "effects/outline/outline_joined.kernel.h"

FN void outline_join_pixel(Int px, Int py) {
  store_outline_join(join_of(px, py, near_outline_steep_trimmed(0, 0), near_outline_flat_trimmed(0, 0)));
}
