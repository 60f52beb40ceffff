// What outline_strays tells of dropped.
//
// Planes: pieces of line as outline_piece.kernel.h has them, and what joins them, as outline_stroke.kernel.h has it.
IN_REAL(outline_steep_trimmed)
IN_REAL(outline_flat_trimmed)
IN_REAL(outline_join)
IN_REAL(outline_strays)
OUT_REAL(outline_steep_left)
OUT_REAL(outline_flat_left)
OUT_REAL(outline_join_left)
FN Real steep_at(Int x, Int y) { return load_outline_steep_trimmed(x, y); }
FN Real flat_at(Int x, Int y) { return load_outline_flat_trimmed(x, y); }
FN Real told_at(Int x, Int y) { return load_outline_strays(x, y); }
FN Real told_near(int i, int j) { return near_outline_strays(i, j); }
#include "effects/outline/outline_lost.kernel.h"

// This pixel's piece of a kind, or nothing if it is of a stray.
FN Real left_of(Int px, Int py, Real piece, int lying) {
  Bool on = is_piece(piece);
  if (!some(on)) return piece;
  Bool lost = tail_at(on, px, py, piece, lying, -1, int(kMostLost)).lost;
  lost = on && (lost || tail_at(on, px, py, piece, lying, 1, int(kMostLost)).lost);
  return select(lost, Real(0.0f), piece);
}

FN void outline_drop_pixel(Int px, Int py) {
  Real steep = left_of(px, py, near_outline_steep_trimmed(0, 0), 0);
  Real lower = left_of(px, py, near_outline_flat_trimmed(0, 0), 1);
  Real join = near_outline_join(0, 0);
  store_outline_steep_left(steep);
  store_outline_flat_left(lower);
  store_outline_join_left(select(is_piece(steep) || is_piece(lower), join, Real(0.0f)));
}
