// Strays and islets dropped, and what goes on past joins, as outline_strays tells them, and crumbs on their way.
//
// Planes: pieces of line as outline_piece.kernel.h has them.
IN_REAL(object_id)
IN_REAL(outline_steep_trimmed)
IN_REAL(outline_flat_trimmed)
IN_REAL(outline_join)
IN_REAL(outline_strays)
IN_REAL(outline_strays_near)
OUT_REAL(outline_steep_left)
OUT_REAL(outline_flat_left)
FN Real steep_at(Int x, Int y) { return load_outline_steep_trimmed(x, y); }
FN Real flat_at(Int x, Int y) { return load_outline_flat_trimmed(x, y); }
FN Real told_at(Int x, Int y) { return load_outline_strays(x, y); }
#include "effects/outline/outline_lost.kernel.h"
FN Bool told_near(int i, int j) { return abs(near_outline_strays(i, j)) > 0.0f; }
#include "effects/outline/outline_islet.kernel.h"

CONST int kBrief = 20;      // rows of what may be a crumb
CONST int kCrumb = 2;       // pixels from a piece, within which another one
CONST float kUpon = 0.8f;   // that is so near its way
CONST float kAlike = 0.5f;  // and leans alike, sine, is of the same line

// Whether any end that is told of is so near that what leads there is to be found: twenty-five squares without a gap
// between them are as wide as a line of kMostLost rows leans.
FN Bool strays_around(Int px, Int py) {
  int apart = 2 * kOutlineStraysNear + 1;
  Uint any = Uint(0u);
  for (int j = -2 * apart; j <= 2 * apart; j += apart)
    for (int i = -2 * apart; i <= 2 * apart; i += apart) {
      // What lies beyond the picture's border reads as what is at it.
      any = any | bits_of(load_outline_strays_near(px + Int(i), py + Int(j)));
    }
  return !(to_signed(any) == Int(0));
}

// Whether a piece is of what is dropped, and how many rows its line has around it, as far as that is followed.
struct Lost {
  Bool on;
  Bool told;  // something of its line is
  Int rows;
};

// The same of a piece of pixel (x, y).
FN_RARE Lost lost_of(Bool asked, Int x, Int y, Real piece, Bool steep) {
  Tail up = tail_at(asked, x, y, piece, steep, -1, int(kMostLost), true);
  Tail down = tail_at(asked, x, y, piece, steep, 1, int(kMostLost), true);
  return Lost(asked && (up.lost || down.lost), up.told || down.told, up.rows + down.rows);
}

// This pixel's piece of a kind, or nothing if it is of a stray, or a crumb on the way of one.
FN Real left_of(Bool asked, Int px, Int py, Real piece, int lying) {
  Bool on = asked && is_piece(piece);
  if (!some(on)) return piece;
  Lost own = lost_of(on, px, py, piece, steep_of(lying));
  Bool lost = own.on;
  Bool brief = on && own.rows < Int(kBrief) && !own.told;
  Vec2 at = middle_of(piece, steep_of(lying), 0.0f);
  Vec2 way = lean_of(slope_of(piece), steep_of(lying), Real(1.0f));
  for (int j = -kCrumb; j <= kCrumb; ++j)
    for (int i = -kCrumb; i <= kCrumb; ++i)
      for (int kind = 0; kind < 2; ++kind) {
        Bool look = brief && !lost;
        if (!some(look)) continue;
        Real other = piece_at(kind, px + Int(i), py + Int(j));
        Bool upon = look && is_piece(other);
        if (!some(upon)) continue;
        Vec2 apart = apart_from(at, other, kind, Int(i), Int(j), 0.0f);
        Vec2 lean = lean_of(slope_of(other), steep_of(kind), Real(1.0f));
        upon = upon && abs(cross(lean, apart)) < kUpon && abs(cross(way, lean)) < kAlike;
        if (some(upon)) lost = lost || lost_of(upon, px + Int(i), py + Int(j), other, steep_of(kind)).on;
      }
  return select(on && lost, Real(0.0f), piece);
}

FN void outline_drop_pixel(Int px, Int py) {
  Real steep = near_outline_steep_trimmed(0, 0);
  Real lower = near_outline_flat_trimmed(0, 0);
  Bool any = is_piece(steep) || is_piece(lower);
  Bool strays = any;
  if (some(any)) strays = any && strays_around(px, py);
  if (some(strays)) {
    steep = left_of(strays, px, py, steep, 0);
    lower = left_of(strays, px, py, lower, 1);
    Bool islet = strays && (is_piece(steep) || is_piece(lower));
    if (some(islet)) islet = is_islet(islet);
    steep = select(islet && is_piece(steep), Real(0.0f), steep);
    lower = select(islet && is_piece(lower), Real(0.0f), lower);
  }
  store_outline_steep_left(steep);
  store_outline_flat_left(lower);
}
