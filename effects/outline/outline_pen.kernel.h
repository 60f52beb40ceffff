// How wide a line is drawn, as by a pen: thinner with distance, thinner the less of a surface another part of it hides,
// as wide, and as much on one side, as it is around, in a point where it ends free; and gaps of a few rows closed,
// which wide lines cover and thin ones do not.
//
// Planes: pieces of line as outline_piece.kernel.h has them, and what joins them, as outline_stroke.kernel.h has it.
IN_REAL(depth)
IN_REAL(object_id)
IN_REAL(material_id)
IN_REAL(outline_steep_left)
IN_REAL(outline_flat_left)
IN_REAL(outline_join_left)
OUT_REAL(outline_steep_pen)
OUT_REAL(outline_flat_pen)
OUT_REAL(outline_join_pen)
FN Real steep_at(Int x, Int y) { return load_outline_steep_left(x, y); }
FN Real flat_at(Int x, Int y) { return load_outline_flat_left(x, y); }
#include "effects/outline/outline_end.kernel.h"

CONST int kPen = 3;            // rows to either side over which a line is even, and one more per pixel of stride
CONST float kPenAside = 1.1f;  // pixels beside a line's way, up to which a piece is of it
CONST float kPenBend = 0.5f;   // and more per row, up to which it is near a free end
CONST float kLeastPen = 1.0f;  // of kSure: what is drawn does not vanish

// What lies on both sides of a crossing between pixel (i, j) and the next one, to the right (lying 0) or below.
struct Sides {
  Bool seen;     // neither is background
  Bool within;   // both are of one object and, if those are parted, of one material
  Real nearer;   // depth of the nearer surface,
  Real farther;  // and of the other one; a pixel beside it, if the jump is greater there
};

FN Sides sides_of(int lying, int i, int j) {
  int i2 = lying == 0 ? i + 1 : i;
  int j2 = lying == 0 ? j : j + 1;
  Real depth1 = near_depth(i, j);
  Real depth2 = near_depth(i2, j2);
  Bool first = is_surface(depth1);
  Bool second = is_surface(depth2);
  Bool within = first && second && near_object_id(i, j) == near_object_id(i2, j2);
  if (C.materials != 0) within = within && near_material_id(i, j) == near_material_id(i2, j2);
  depth1 = select(first, depth1, select(second, depth2, Real(1.0f)));
  depth2 = select(second, depth2, depth1);
  Real nearer = min(depth1, depth2);
  Real farther = max(depth1, depth2);
  // A line can be drawn a pixel beside where it was found. Asked only where it counts.
  if (C.inner > 0.0f) {
    Real before = near_depth(i + i - i2, j + j - j2);
    Real after = near_depth(i2 + i2 - i, j2 + j2 - j);
    Real jump = max(select(is_surface(before), abs(before - depth1), Real(0.0f)),
                    select(is_surface(after), abs(after - depth2), Real(0.0f)));
    farther = select(within, max(farther, nearer + jump), farther);
  }
  return Sides(first && second, within, nearer, farther);
}

// The share of its width that a line has there. Things become smaller in proportion to their distance; lines, at most,
// by its square root, or those that are far would be gone. A rim within one object becomes thinner the less what it
// hides lies behind it: that by which it does, in pixel sizes, is 0 where a fold begins.
FN Real pen_share(Sides sides, Real piece) {
  Real share = Real(1.0f);
  Real pixel = Real(F.ray_scale_x);
  if (F.orthographic == 0) {
    Real distant = sqrt(min(Real(C.recede_from) / max(sides.nearer, Real(1e-30f)), Real(1.0f)));
    share = mad(distant - 1.0f, Real(C.recede), share);
    pixel = pixel * sides.nearer;
  }
  Real jump = (sides.farther - sides.nearer) / max(pixel, Real(1e-30f));
  Real less = Real(C.inner * C.inner_px) / (jump + C.inner_px);
  return share * select(sides.within && !is_crease(piece) && !leans(piece), Real(1.0f) - less, Real(1.0f));
}

// Whether there is another line than its own near a piece, or one of the two is joined to anything, within so many
// pixels: its end is not free.
FN_RARE Bool has_company(Bool asked, int lying, Real place, Real slope, int within) {
  Bool met = asked && !asked;
  for (int j = -within; j <= within; ++j)
    for (int i = -within; i <= within; ++i) {
      Bool look = asked && !met;
      if (!some(look)) continue;
      Real steep = near_outline_steep_left(i, j);
      Real lower = near_outline_flat_left(i, j);
      Real along = lying == 0 ? steep : lower;
      Real across = lying == 0 ? lower : steep;
      Real off = place_of(along) + Real(float(lying == 0 ? i : j)) - mad(slope, Real(float(lying == 0 ? j : i)), place);
      Real bends = Real(kPenAside + kPenBend * float(lying == 0 ? (j < 0 ? -j : j) : (i < 0 ? -i : i)));
      Bool other = is_piece(across) || (is_piece(along) && !(abs(off) < bends));
      met = met || (look && (other || has_join(bits_of(near_outline_join_left(i, j)))));
    }
  return met;
}

// The same piece, as wide as it is drawn, and as its line is in the rows (columns) around it, unless it is a rim before
// the background, which lies wholly on one side anyway.
FN Real penned(int lying, Int px, Int py, Real piece) {
  Bool on = is_piece(piece);
  if (!some(on)) return piece;
  bool shares = C.recede > 0.0f || C.inner > 0.0f;
  Sides sides = sides_of(lying, 0, 0);
  Real width = sure_of(piece);
  if (shares) width = width * pen_share(sides, piece);
  Real level = level_of(piece);
  Bool even = on && sides.seen;
  if (some(even)) {
    Real place = place_of(piece);
    Real slope = slope_of(piece);
    Real none = Real(0.0f);
    Real levels = none;
    Real widths = none;
    Real count = none;
    Real before = none;  // rows above (columns to the left) as far as which the line goes on, and
    Real after = none;   // below
    int rows = kPen + C.stride;
    for (int j = -rows; j <= rows; ++j) {
      int most = (j < 0 ? -j : j) + 1;
      Real expected = floor(mad(slope, Real(float(j)), place) + kHalfway);
      // It leaves the picture.
      Bool any = lying == 0 ? !in_picture(px + to_int(expected), py + Int(j))
                            : !in_picture(px + Int(j), py + to_int(expected));
      for (int i = -most; i <= most; ++i) {
        Real other = lying == 0 ? near_outline_steep_left(i, j) : near_outline_flat_left(j, i);
        Real off = place_of(other) + Real(float(i)) - mad(slope, Real(float(j)), place);
        Bool here = even && is_piece(other) && abs(off) < kPenAside;
        if (!some(here)) continue;
        any = any || here;
        Sides beside = sides_of(lying, lying == 0 ? i : j, lying == 0 ? j : i);
        here = here && beside.seen && side_of(other) * side_of(piece) > -kHasSide;
        Real counts = select(here, Real(float(rows + 2 - most)), Real(0.0f));
        Real wide = sure_of(other);
        if (shares) wide = wide * pen_share(beside, other);
        count = count + counts;
        levels = mad(level_of(other), counts, levels);
        widths = mad(wide, counts, widths);
      }
      if (j < 0) before = select(any, max(before, Real(float(-j))), before);
      if (j > 0) after = select(any, Real(float(j)), after);
    }
    Real per = Real(1.0f) / max(count, Real(1.0f));
    Bool known = even && count > 0.0f;  // what closes a gap is not there yet
    width = select(known, widths * per, width);
    level = select(known, levels * per, level);
    // A free end within one object is a point.
    if (C.inner > 0.0f) {
      Real left = min(before, after);
      Bool ends = even && sides.within && left < Real(float(rows));
      if (some(ends)) ends = ends && !has_company(ends, lying, place, slope, rows + 1);
      Real point = (left + 1.0f) * Real(1.0f / float(rows + 1)) - 1.0f;
      width = select(ends, width * mad(point, Real(C.inner), Real(1.0f)), width);
    }
  }
  Uint sure = to_uint(to_int(max(width + kRounds, Real(kLeastPen))));
  Uint side = to_uint(to_int(level + kRounds));
  return select(on, real_of_bits((bits_of(piece) & Uint(0xf000ffffu)) | (side << 16) | (sure << 23)), piece);
}

CONST int kBridge = 3;            // rows from a gap to the pieces on its two sides
CONST float kBridgeRows = 4.5f;   // rows between those at most
CONST float kPlaces = 0.99f;      // from the middle between two pixels: what a piece can tell, see outline_piece
CONST int kPlacesAside = 3;       // pixels beside, at which another piece may be at the same place
CONST float kBridgeBend = 0.6f;   // how much the slopes of those may differ from the way between them,
CONST float kBridgeTurn = 16.5f;  // and their levels from each other

// A piece of a line's way to one side of this pixel.
struct Bank {
  Real row, place;  // where it crosses, counted from this pixel's; row 0 if there is none
  Real piece;
};

FN Bank bank_of(int lying, int towards) {
  Real none = Real(0.0f);
  Bank bank = Bank(none, none, none);
  for (int k = 1; k <= kBridge; ++k)
    for (int i = -k - 1; i <= k + 1; ++i) {
      Real other = lying == 0 ? near_outline_steep_left(i, k * towards) : near_outline_flat_left(k * towards, i);
      Bool here = is_piece(other) &&
                  (bank.row == none || (bank.row == Real(float(k * towards)) && abs(Real(float(i))) < abs(bank.place)));
      bank.row = select(here, Real(float(k * towards)), bank.row);
      bank.place = select(here, Real(float(i)), bank.place);
      bank.piece = select(here, other, bank.piece);
    }
  bank.place = bank.place + place_of(bank.piece);
  return bank;
}

// What a line has here, where a surface ends but nothing is drawn, if it goes on in rows above and below (columns to
// the left and right) alike: a wide line covers such gaps, a thin one would be broken.
FN Real bridged(int lying, Real piece) {
  Bool asked = abs(piece) > 0.0f && !is_piece(piece);
  if (!some(asked)) return piece;
  Bank up = bank_of(lying, -1);
  asked = asked && is_piece(up.piece);
  if (!some(asked)) return piece;
  Bank down = bank_of(lying, 1);
  asked = asked && is_piece(down.piece);
  if (!some(asked)) return piece;
  Real slope = (down.place - up.place) / max(down.row - up.row, Real(1.0f));
  Real place = mad(slope, -up.row, up.place);
  asked = asked && down.row - up.row < Real(kBridgeRows) && abs(place - 0.5f) < kPlaces && abs(slope) < kSteepest;
  asked = asked && abs(slope_of(up.piece) - slope) < kBridgeBend && abs(slope_of(down.piece) - slope) < kBridgeBend;
  asked = asked && abs(level_of(up.piece) - level_of(down.piece)) < kBridgeTurn;
  // Where its line is a pixel beside there is no gap.
  for (int i = -kPlacesAside; i <= kPlacesAside; ++i) {
    Real other = lying == 0 ? near_outline_steep_left(i, 0) : near_outline_flat_left(0, i);
    asked = asked && !(is_piece(other) && abs(place_of(other) + Real(float(i)) - place) < kPenAside);
  }
  Real level = floor((level_of(up.piece) + level_of(down.piece)) * 0.5f + kRounds);
  Real found = packed_piece(place, slope, level, min(sure_of(up.piece), sure_of(down.piece)));
  return select(asked, found, piece);
}

FN void outline_pen_pixel(Int px, Int py) {
  Real steep = bridged(0, near_outline_steep_left(0, 0));
  Real lower = bridged(1, near_outline_flat_left(0, 0));
  Real join = near_outline_join_left(0, 0);
  Bool any = is_piece(steep) || is_piece(lower);
  if (some(any)) {
    // What joins a line to another is as wide as it.
    Bool joined = has_join(bits_of(join));
    Real before = sure_of(select(joined_steep(join), steep, lower));
    steep = penned(0, px, py, steep);
    lower = penned(1, px, py, lower);
    Real after = sure_of(select(joined_steep(join), steep, lower));
    join = select(joined, with_sure(join, joined_sure(join) * min(after / max(before, Real(1.0f)), Real(1.0f))), join);
  }
  store_outline_steep_pen(steep);
  store_outline_flat_pen(lower);
  join = select(abs(join) > 0.0f, join, Real(kOnlyEnds));
  store_outline_join_pen(select(any, join, Real(0.0f)));
}
