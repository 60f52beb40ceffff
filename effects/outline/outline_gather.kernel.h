// What lies along each pixel's row, so that `outline` passes over the rest: all bits of outline_join_pen as far as
// lines reach, and from there on, as far as most of what joins them reaches, whether there is a joined end, and one
// that is joined far.
IN_REAL(outline_join_pen)
OUT_REAL(outline_around)
#include "effects/outline/outline_piece.kernel.h"
#include "effects/outline/outline_stroke.kernel.h"

FN Real bits_around(int sight) {
  Uint any = Uint(0u);
  for (int i = -sight; i <= sight; ++i) any = any | bits_of(near_outline_join_pen(i, 0));
  Uint far = Uint(0u);
  for (int i = sight + 1; i <= C.gather; ++i)
    far = far | bits_of(near_outline_join_pen(-i, 0)) | bits_of(near_outline_join_pen(i, 0));
  return real_of_bits(any | (far & ((Uint(1u) << kJoinedBit) | (Uint(1u) << kFarBit))));
}

FN void outline_gather_pixel(Int px, Int py) {
  store_outline_around(C.sight == kOutlineUsualSight ? bits_around(kOutlineUsualSight) : bits_around(C.sight));
}
