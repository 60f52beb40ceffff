// Tails, spurs, burrs, hooks and strays dropped, as outline_tails tells them, and what is faint between two lines made
// as sure as they: a fold between two rims of a mesh's triangles is a crease, clear in some rows and faint in others.
// What is faint and short and leads nowhere is dropped, too, and what is so faint beside another line that it would be
// specks. What is left of two lines that overlapped outline_join joins.
//
// Planes: pieces of line as outline_piece.kernel.h has them.
IN_REAL(outline_steep_even)
IN_REAL(outline_flat_even)
IN_REAL(outline_tails)
OUT_REAL(outline_steep_trimmed)
OUT_REAL(outline_flat_trimmed)
FN Real steep_at(Int x, Int y) { return load_outline_steep_even(x, y); }
FN Real flat_at(Int x, Int y) { return load_outline_flat_even(x, y); }
FN Real told_at(Int x, Int y) { return load_outline_tails(x, y); }
#include "effects/outline/outline_lost.kernel.h"

CONST int kBetween = 16;       // rows, per pixel of stride, of what is faint between two lines,
CONST int kStraight = 32;      // of a crease that goes straight on in what is sure, both ways,
CONST float kBent = 0.1f;      // with less than this between its slopes,
CONST int kNowhere = 20;       // and of what leads nowhere
CONST float kHair = 7.5f;      // sure_of up to which it is not drawn beside another line
CONST float kFade = 2.0f;      // times faster than it was found to
CONST float kNoSide = 0.25f;   // of a crease, or nearly one
CONST float kAbreast = 1.5f;   // pixels before or after a piece, at which that has another line beside
CONST int kMeets = 2;          // pixels, and the stride, from an end at which what is faint meets a line,
CONST float kBehind = 1.0f;    // so many behind it
CONST float kAsideOf = 2.0f;   // and so many aside;
CONST float kBesideIt = 1.2f;  // but not what is so many aside and runs alongside,
CONST float kAlongIt = 0.3f;   // with less than this between the two ways, sine;
CONST float kOnward = 1.0f;    // what is not so many ahead
CONST float kOwn = 0.8f;       // nor so many aside is of the line itself
CONST float kAlike = 0.5f;     // between ways, sine: more is another line's
CONST int kDot = 2;            // rows that are left at the end of what is dropped, at most, and are dropped, too

// Whether any end that is told of is so near that this pixel's piece is asked whether it is of its tail.
FN Bool end_around() {
  int rows = tail_rows() < kMostTail ? tail_rows() + 1 : kMostTail;
  Uint any = Uint(0u);
  for (int j = -rows; j <= rows; ++j)
    for (int i = -rows; i <= rows; ++i) any = any | bits_of(near_outline_tails(i, j));
  return !(to_signed(any) == Int(0));
}

// Whether another line, surer than `least`, is beside the piece of pixel (X, Y). crease: one that is a crease, or
// nearly.
FN_RARE Bool has_beside(Bool asked, Int X, Int Y, Real piece, Bool steep, float least, bool crease) {
  Vec2 way = lean_of(slope_of(piece), steep, Real(1.0f));
  Vec2 at = middle_of(piece, steep, 0.0f);
  Vec2 nearer = nearer_of(piece, steep);
  Bool found = asked && !asked;
  int wide = int(alongside()) + 3;
  for (int j = -wide; j <= wide; ++j)
    for (int i = -wide; i <= wide; ++i)
      for (int kind = 0; kind < 2; ++kind) {
        Bool look = asked && !found;
        if (!some(look)) continue;
        Real other = piece_at(kind, X + Int(i), Y + Int(j));
        Bool here = look && seen(other) && sure_of(other) > least && stands_for(other, piece);
        if (!some(here)) continue;
        Vec2 apart = apart_from(at, other, kind, Int(i), Int(j), 0.0f);
        Real off = abs(cross(way, apart));
        here = here && dot(nearer_of(other, steep_of(kind)), nearer) > -kHasSide;
        if (crease) here = here && abs(side_of(other)) < kNoSide;
        found = found || (here && abs(dot(way, apart)) < kAbreast && off > kOther && off < alongside());
      }
  return found;
}

// How sure the surest piece is of those at pixel (X, Y) and near it that are not behind what leads there, nor of it
// itself; 0 for none.
FN_RARE Real meets(Bool asked, Int X, Int Y, Vec2 at, Vec2 way) {
  Real surest = Real(0.0f);
  int wide = C.stride + kMeets;
  for (int j = -wide; j <= wide; ++j)
    for (int i = -wide; i <= wide; ++i)
      for (int lying = 0; lying < 2; ++lying) {
        Bool look = asked && !(surest > kWhole);
        if (!some(look)) continue;
        Real piece = piece_at(lying, X + Int(i), Y + Int(j));
        Bool here = look && is_piece(piece);
        if (!some(here)) continue;
        Vec2 apart = apart_from(at, piece, lying, Int(i), Int(j), 0.0f);
        Real ahead = dot(way, apart);
        Real aside = abs(cross(way, apart));
        Bool own = sure_of(piece) < kWhole && ahead < kOnward && aside < kOwn;
        // What runs alongside is not met.
        Vec2 lean = lean_of(slope_of(piece), steep_of(lying), Real(1.0f));
        Bool along = aside > kBesideIt && abs(cross(way, lean)) < kAlongIt;
        here = here && !own && !along && ahead > -kBehind && aside < kAsideOf;
        surest = select(here, max(surest, sure_of(piece)), surest);
      }
  return surest;
}

// What goes on ahead of where a faint line ends, its way and on its side.
struct Ahead {
  Bool sure;    // a line that is sure
  Along faint;  // or one that is faint, too: the first
};

// What goes on ahead of a line's end as far as ends are joined.
FN_RARE Ahead ahead_of(Bool asked, Along end, Vec2 at, Vec2 way) {
  Ahead found = Ahead(asked && !asked, end);
  found.faint.on = found.sure;
  Vec2 nearer = nearer_of(end.piece, end.steep);
  Bool crease = is_crease(end.piece);
  for (int k = 1; k <= C.join; ++k) {
    Int x = to_int(floor(mad(way.x, Real(float(k)), at.x + 0.5f)));
    Int y = to_int(floor(mad(way.y, Real(float(k)), at.y + 0.5f)));
    for (int m = 0; m < 3; ++m)
      for (int lying = 0; lying < 2; ++lying) {
        int j = m < 2 ? -m : 1;  // straight ahead first
        Bool look = asked && !found.sure;
        if (!some(look)) continue;
        Int i = x + select(end.steep, Int(j), Int(0));
        Int l = y + select(end.steep, Int(0), Int(j));
        Real piece = piece_at(lying, end.x + i, end.y + l);
        Bool here = look && is_piece(piece);
        if (!some(here)) continue;
        Vec2 apart = apart_from(at, piece, lying, i, l, 0.0f);
        Vec2 lean = lean_of(slope_of(piece), steep_of(lying), Real(1.0f));
        here = here && abs(cross(way, apart)) < kAbreast && dot(way, apart) > kOnward &&
               dot(nearer_of(piece, steep_of(lying)), nearer) > -kHasSide;
        // A crease also leads to a rim that ends its surface.
        Bool rim = here && crease && abs(side_of(piece)) > kHasSide && sure_of(piece) > kWhole;
        found.sure = found.sure || rim;
        here = here && abs(cross(way, lean)) < kAlike;
        Bool sure = here && sure_of(piece) > kWhole;
        found.sure = found.sure || sure;
        Bool first = here && !sure && !found.faint.on;
        found.faint = Along(found.faint.on || first, select(first, place_of(piece), found.faint.place),
                            select(first, slope_of(piece), found.faint.slope), select(first, end.x + i, found.faint.x),
                            select(first, end.y + l, found.faint.y), chosen(first, steep_of(lying), found.faint.steep),
                            select(first, piece, found.faint.piece), end.least);
      }
  }
  return found;
}

// Whether of a tail that ends so near, to one side, with nothing ahead, what leads there is dropped: what is left would
// be a dot.
FN_RARE Bool is_dot(Bool asked, Tail tail, Int px, Int py, Real piece, int lying, int side) {
  Bool steep = steep_of(lying);
  Along back = Along(asked && tail.near && tail.rows < Int(kDot), place_of(piece), slope_of(piece), px, py, steep,
                     piece, Real(0.0f));
  Bool left = asked && !asked;
  for (int k = 1; k <= kDot; ++k) {
    back.on = back.on && tail.rows + Int(k) <= Int(kDot);
    if (!some(back.on)) continue;
    back = next_along(back, px, py, steep, Int(-k * side), Real(float(-side)));
    if (some(back.on))
      left = left || (back.on && has_beside(back.on, back.x, back.y, back.piece, back.steep, kLeastSeen, false));
  }
  if (some(left)) {
    Real towards = Real(float(side));
    Along last = Along(left, place_of(piece), slope_of(piece), px, py, steep, piece, Real(0.0f));
    for (int k = 1; k <= kDot; ++k)
      if (some(last.on)) last = next_along(last, px, py, steep, Int(k * side), towards);
    Ahead ahead = ahead_of(left, last, middle_of(last.piece, last.steep, 0.0f), lean_of(last.slope, steep, towards));
    left = left && !(ahead.sure || ahead.faint.on);
  }
  return left;
}

// This pixel's piece, or nothing if it is lost, or a dot, or of a tail, or between two, and has the other line beside
// it; of what is left of these, marked as an end: it is one where the rest is dropped. own: the piece as it was, since
// what stands for it is known as it was, too.
FN_RARE Real without_tails(Bool asked, Int px, Int py, Real own, Real piece, int lying) {
  Tail up = tail_at(asked, px, py, piece, steep_of(lying), -1, tail_rows(), false);
  Tail down = tail_at(asked, px, py, piece, steep_of(lying), 1, tail_rows(), false);
  Bool dropped = up.lost || down.lost;
  Bool tail = up.near || down.near || (up.passed && down.passed);
  Bool ask = tail && !dropped;
  if (some(ask)) dropped = dropped || has_beside(ask, px, py, own, steep_of(lying), kLeastSeen, false);
  ask = ask && !dropped;
  if (some(ask)) dropped = dropped || is_dot(ask, up, px, py, piece, lying, -1);
  if (some(ask)) dropped = dropped || is_dot(ask, down, px, py, piece, lying, 1);
  return select(dropped, Real(0.0f), select(tail || up.last || down.last, -abs(piece), piece));
}

// Where a line leads that is faint, to one side of it.
struct Led {
  Bool on;       // to a line that is sure,
  Bool crease;   // which is the same crease,
  Bool ends;     // it ends with none near,
  Bool weakly;   // or only with what is faint, too,
  Int rows;      // so many rows away
  Along onward;  // and a faint one goes on from there,
  Real towards;  // to this side of that
};

// most: rows, per pixel of stride, that a crease is followed for.
FN_RARE Led led_to(Along from, Real towards, int most) {
  Bool steep = from.steep;
  Along last = from;
  Bool found = from.on && !from.on;
  Bool ends = found;
  Int side = to_int(towards);
  Int rows = Int(0);
  Bool crease = is_crease(from.piece);
  for (int k = 1; k <= most * C.stride; ++k) {
    if (k > kBetween * C.stride) last.on = last.on && crease;
    if (!some(last.on)) continue;
    Along next = next_along(last, from.x, from.y, steep, side * Int(k), towards);
    if (k <= kBetween * C.stride) ends = ends || (last.on && !next.on);
    last = next;
    found = found || (last.on && sure_of(last.piece) > kWhole);
    last.on = last.on && !found;
    rows = select(last.on, Int(k), rows);
  }
  ends = ends && goes_inside(last, from.x, from.y, steep, (rows + Int(1)) * side, towards);
  last.on = ends && !ends;
  Bool same = found && crease && is_crease(last.piece);
  Led led = Led(found, same, ends, ends && !ends, rows, last, towards);
  if (some(ends)) {
    Vec2 way = lean_of(last.slope, steep, towards);
    Vec2 at = middle_of(last.piece, last.steep, 0.0f);
    Real met = meets(ends, last.x, last.y, at, way);
    led.on = found || (ends && met > kWhole);
    led.ends = ends && !(met > 0.0f);
    led.weakly = ends && !led.on && !led.ends;
    Bool look = ends && !led.on;
    if (some(look)) {
      Ahead ahead = ahead_of(look, last, at, way);
      led.on = led.on || ahead.sure;
      led.onward = ahead.faint;
      led.towards =
          select(dot(lean_of(ahead.faint.slope, ahead.faint.steep, Real(1.0f)), way) < 0.0f, Real(-1.0f), Real(1.0f));
    }
  }
  return led;
}

// The same, also by way of another faint line that goes on beyond a gap.
FN_RARE Led led_on(Bool asked, Int px, Int py, Real piece, int lying, int side) {
  Led led = led_to(Along(asked, place_of(piece), slope_of(piece), px, py, steep_of(lying), piece, Real(0.0f)),
                   Real(float(side)), kStraight);
  led.onward.on = led.onward.on && !led.on;
  if (some(led.onward.on)) {
    Led second = led_to(led.onward, led.towards, kBetween);
    Bool on = led.onward.on && second.on;
    led.on = led.on || on;
    Real apart = max(abs(to_real(led.onward.x - px)), abs(to_real(led.onward.y - py)));
    // What meets but faint lines, and goes on in one that leads nowhere, leads nowhere.
    Bool nowhere = led.weakly && led.onward.on && !second.on && second.ends;
    led.ends = led.ends || nowhere;
    led.rows = select(on || nowhere, to_int(apart) + second.rows, led.rows);
  }
  return led;
}

FN Real trimmed(Int px, Int py, Real piece, int lying, Bool near_end) {
  Real own = piece;
  Bool on = is_piece(piece);
  Bool faint = on && sure_of(piece) < kWhole;
  // What is so faint beside another line would be specks.
  Bool hair = faint && sure_of(piece) < kHair;
  if (some(hair)) hair = hair && has_beside(hair, px, py, piece, steep_of(lying), kHair, false);
  if (some(faint)) {
    Led up = led_on(faint, px, py, piece, lying, -1);
    faint = faint && (up.on || up.ends);
    if (some(faint)) {
      Led down = led_on(faint, px, py, piece, lying, 1);
      Int rows = up.rows + down.rows;
      Bool straight = up.crease && down.crease && abs(up.onward.slope - down.onward.slope) < kBent;
      Int most = select(straight, Int(kStraight), Int(kBetween)) * C.stride;
      Bool between = faint && up.on && down.on && rows < most;
      Bool linked = (up.on && down.onward.on) || (up.onward.on && down.on);
      Bool nowhere = faint && !between && !linked && up.ends && down.ends && rows < Int(kNowhere * C.stride);
      piece = select(between, without_doubt(piece), select(nowhere, Real(0.0f), piece));
      hair = hair && !between;
    }
  }
  piece = select(hair, Real(0.0f), piece);
  // Of two creases that come together the one that is not sure, still, fades up to there.
  Bool fades = is_piece(piece) && is_crease(piece) && sure_of(piece) > kHair && sure_of(piece) < kWhole;
  if (some(fades)) {
    fades = fades && has_beside(fades, px, py, piece, steep_of(lying), kWhole, true);
    Real less = floor(mad(sure_of(piece), Real(kFade), Real(kSure - kSure * kFade + 0.5f)));
    piece = select(fades, as_sure(piece, less), piece);
  }
  Bool look = near_end && is_piece(piece);
  if (some(look)) piece = select(look, without_tails(look, px, py, own, piece, lying), piece);
  return piece;
}

FN void outline_trim_pixel(Int px, Int py) {
  Real steep = near_outline_steep_even(0, 0);
  Real lower = near_outline_flat_even(0, 0);
  Bool any = is_piece(steep) || is_piece(lower);
  if (some(any)) {
    Bool near_end = any && end_around();
    if (some(is_piece(steep))) steep = trimmed(px, py, steep, 0, near_end);
    if (some(is_piece(lower))) lower = trimmed(px, py, lower, 1, near_end);
  }
  store_outline_steep_trimmed(steep);
  store_outline_flat_trimmed(lower);
}
