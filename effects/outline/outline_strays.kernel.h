// Ends of what trimming left of lines and is to be dropped, too: spurs and strays, as outline_tails has them, that lead
// to nothing. Where a barb was cut off its stem, or a line in two, the rest would be a dash.
//
// outline_strays: as outline_tail.kernel.h has it.
IN_REAL(object_id)
IN_REAL(outline_steep_trimmed)
IN_REAL(outline_flat_trimmed)
OUT_REAL(outline_strays)
FN Real steep_at(Int x, Int y) { return load_outline_steep_trimmed(x, y); }
FN Real flat_at(Int x, Int y) { return load_outline_flat_trimmed(x, y); }
#include "effects/outline/outline_tip.kernel.h"

// What is to be told of the ends of this pixel's piece of one kind.
FN Real told(Int px, Int py, Real piece, int lying) {
  Bool steep = steep_of(lying);
  Along from = Along(is_piece(piece), place_of(piece), slope_of(piece), px, py, steep, piece, Real(0.0f));
  Real code = Real(0.0f);
  for (int side = -1; side <= 1; side += 2) {
    Real towards = Real(float(side));
    Along next = next_along(from, px, py, steep, Int(side), towards);
    Along here = from;
    here.on = from.on && !next.on && goes_inside(from, px, py, steep, Int(side), towards);
    if (!some(here.on)) continue;
    Real lost = stroke_of(tip_of(here.on, here, steep, towards), here, px, py, Int(side), towards, true);
    code = mad(lost, Real(side < 0 ? kLostBefore : kLostAfter), code);
  }
  return code;
}

FN void outline_strays_pixel(Int px, Int py) {
  Real steep = near_outline_steep_trimmed(0, 0);
  Real lower = near_outline_flat_trimmed(0, 0);
  Real code = Real(0.0f);
  if (some(is_piece(steep))) code = told(px, py, steep, 0);
  if (some(is_piece(lower))) code = code + told(px, py, lower, 1) * kOfFlat;
  store_outline_strays(code);
}
