// What outline_strays tells of dropped.
//
// Planes: pieces of line as outline_piece.kernel.h has them.
IN_REAL(outline_steep_trimmed)
IN_REAL(outline_flat_trimmed)
IN_REAL(outline_strays)
OUT_REAL(outline_steep_left)
OUT_REAL(outline_flat_left)
FN Real steep_at(Int x, Int y) { return load_outline_steep_trimmed(x, y); }
FN Real flat_at(Int x, Int y) { return load_outline_flat_trimmed(x, y); }
FN Real told_at(Int x, Int y) { return load_outline_strays(x, y); }
FN Real told_near(int i, int j) { return near_outline_strays(i, j); }
#include "effects/outline/outline_lost.kernel.h"

// This pixel's piece, if it is not lost; marked as an end where what follows is.
FN Real left_of(Int px, Int py, Real piece, int lying) {
  Bool on = is_piece(piece);
  Tail up = tail_at(on, px, py, piece, lying, -1);
  Tail down = tail_at(on, px, py, piece, lying, 1);
  Bool lost = on && (up.lost || down.lost);
  return select(lost, Real(0.0f), select(on && (up.last || down.last), -abs(piece), piece));
}

FN void outline_drop_pixel(Int px, Int py) {
  Real steep = near_outline_steep_trimmed(0, 0);
  Real lower = near_outline_flat_trimmed(0, 0);
  Bool any = is_piece(steep) || is_piece(lower);
  if (some(any)) any = any && end_around();
  if (some(any)) {
    if (some(is_piece(steep))) steep = select(any, left_of(px, py, steep, 0), steep);
    if (some(is_piece(lower))) lower = select(any, left_of(px, py, lower, 1), lower);
  }
  store_outline_steep_left(steep);
  store_outline_flat_left(lower);
}
