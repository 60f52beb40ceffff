// Ends of what is left of lines and is to be dropped, too: dashes that outline_join found nothing for. Where a barb was
// cut off its stem, or a line in two, the rest is such a dash, and where a fold is one for but a few pixels.
//
// A stray is a stroke alone on its surface, up to a fortieth of the picture's height long, a spur a few pieces near
// another line, neither joined nor touching anything at either end.
//
// outline_strays: as outline_tail.kernel.h has it.
IN_REAL(object_id)
IN_REAL(outline_steep_trimmed)
IN_REAL(outline_flat_trimmed)
IN_REAL(outline_join)
OUT_REAL(outline_strays)
FN Real steep_at(Int x, Int y) { return load_outline_steep_trimmed(x, y); }
FN Real flat_at(Int x, Int y) { return load_outline_flat_trimmed(x, y); }
#include "effects/outline/outline_tip.kernel.h"

// Whether an end is joined to another line, or touches one. A line can end twice at one place, in a piece of each kind:
// what joins one of them joins both.
FN_RARE Bool goes_on(Bool asked, Tip end) {
  Bool found = asked && !asked;
  for (int j = -2; j <= 2; ++j)
    for (int i = -2; i <= 2; ++i)
      for (int lying = 0; lying < 2; ++lying) {
        Bool look = asked && !found;
        if (!some(look)) continue;
        Int x = end.x + Int(i);
        Int y = end.y + Int(j);
        Real piece = piece_at(lying, x, y);
        Bool here = look && seen(piece);
        if (!some(here)) continue;
        Real join = select(here, load_outline_join(x, y), Real(0.0f));
        Bool joined = here && has_join(bits_of(join)) && same(joined_steep(join), steep_of(lying));
        Vec2 apart = apart_from(end.at, piece, lying, Int(i), Int(j), 0.0f);
        joined = joined && dot(apart, apart) < kCorner * kCorner;
        found = found || joined || (here && seen_from(end, piece, lying, i, j).touches);
      }
  return found;
}

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
    Tip end = tip_of(here.on, here, steep, towards);
    here.on = here.on && !goes_on(here.on, end);
    if (!some(here.on)) continue;
    Stroke stroke = stroke_from(here, px, py, Int(side), towards, long_stray_rows());
    Bool brief = stroke.on;
    if (some(brief)) brief = brief && !goes_on(brief, stroke.other);
    Bool stray = stroke.rows > Int(kLeastStray);
    Bool alone = brief && stray;
    if (some(alone)) alone = is_alone(alone, end, stroke, here, px, py, Int(side), towards, long_stray_rows());
    Bool spur = brief && !(stroke.rows > Int(spur_rows()));
    spur = spur && within_one(end, steep) && within_one(stroke.other, stroke.steep);
    if (some(spur)) spur = is_spur(spur, spur, stray, end, stroke.other);
    Real lost = select(alone || spur, min(to_real(stroke.rows) + 1.0f, Real(kMostLost)), Real(0.0f));
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
