// Ends of lines: what outline_tails and the passes after it ask of pieces and of the lines that those are of.
// The text before has steep_at(x, y) and flat_at(x, y), which load its planes of pieces.
#include "effects/outline/outline_piece.kernel.h"
#include "effects/outline/outline_stroke.kernel.h"

CONST float kLeastSeen = 4.5f;   // sure_of from which on a piece counts
CONST int kBefore = 4;           // rows (columns) before an end that tell its way,
CONST int kComing = 8;           // rows, per pixel of stride, of a line that tell the way that it comes
CONST float kNearEnough = 0.4f;  // pixels beside where the next is expected, at which no other is looked for
CONST float kAstray = 1.1f;      // pixels from where the next is expected: more is another line
CONST float kHasSide = 0.05f;    // of nearer surfaces

FN Vec2 chosen(Bool first, Vec2 a, Vec2 b) { return Vec2(select(first, a.x, b.x), select(first, a.y, b.y)); }
FN Bool chosen(Bool first, Bool a, Bool b) { return (first && a) || (!first && b); }

// Whether pieces are steep, of one kind for all pixels: steep (lying 0) or flat (1).
FN Bool steep_of(int lying) { return Real(float(lying)) < 0.5f; }

// The piece of a kind at a pixel; none outside the picture.
FN Real piece_at(Bool steep, Int x, Int y) {
  Real piece = Real(0.0f);
  if (some(steep)) piece = select(steep, steep_at(x, y), piece);
  if (some(!steep)) piece = select(steep, piece, flat_at(x, y));
  return select(in_picture(x, y), piece, Real(0.0f));
}

// The same of one kind for all pixels.
FN Real piece_at(int lying, Int x, Int y) {
  Real piece = lying == 0 ? steep_at(x, y) : flat_at(x, y);
  return select(in_picture(x, y), piece, Real(0.0f));
}

FN Bool seen(Real piece) { return is_piece(piece) && sure_of(piece) > kLeastSeen; }

FN Bool same(Bool a, Bool b) { return (a && b) || (!a && !b); }

// Where the middle of a piece's stroke is from a place `at`, counted from a pixel so many before the piece's.
FN Vec2 apart_from(Vec2 at, Real piece, int lying, Int i, Int j, float width) {
  return middle_of(piece, steep_of(lying), width) + Vec2(to_real(i), to_real(j)) - at;
}

FN Real cross(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }

// The unit vector along a line that began in a piece of a kind and leans so, to one side.
FN Vec2 lean_of(Real slope, Bool steep, Real towards) {
  Vec2 lean = Vec2(select(steep, slope, Real(1.0f)), select(steep, Real(1.0f), slope)) * towards;
  return lean * (Real(1.0f) / sqrt(dot(lean, lean)));
}

// Whether a piece is of a crease, which has no nearer surface.
FN Bool is_crease(Real piece) { return abs(side_of(piece)) < kHasSide; }

// The unit vector from a piece to its nearer surface, shorter if it lies partly on either side.
FN Vec2 nearer_of(Real piece, Bool steep) {
  Real slope = slope_of(piece);
  Real side = side_of(piece) / sqrt(mad(slope, slope, Real(1.0f)));
  return Vec2(select(steep, -side, slope * side), select(steep, slope * side, -side));
}

// A place on the way along a line, row by row (column by column, if it began in a flat piece).
struct Along {
  Bool on;            // it goes on to there
  Real place, slope;  // where it crosses that row, from the pixel that it began at, and how it leans there
  Int x, y;           // pixel of its piece there
  Bool steep;         // kind of that
  Real piece;         // that
  Real least;         // how sure pieces must be to count
};

FN Along chosen(Bool first, Along a, Along b) {
  return Along(chosen(first, a.on, b.on), select(first, a.place, b.place), select(first, a.slope, b.slope),
               select(first, a.x, b.x), select(first, a.y, b.y), chosen(first, a.steep, b.steep),
               select(first, a.piece, b.piece), select(first, a.least, b.least));
}

// The next place, in row `row`, counted from pixel (X, Y), one farther to `towards`: the piece of the same kind that is
// nearest to where it is expected, or else one of the other kind.
FN Along next_along(Along from, Int X, Int Y, Bool steep, Int row, Real towards) {
  Along next = from;
  Real expected = mad(from.slope, towards, from.place);
  Int first = to_int(floor(expected + kHalfway));
  Int beside = select(expected + kHalfway - floor(expected + kHalfway) < 0.5f, Int(-1), Int(1));
  Real nearest = Real(kAstray);
  Bool found = from.on && !from.on;
  for (int i = 0; i < 5; ++i) {
    bool alike = i < 3;
    Bool kind = alike ? steep : !steep;
    Int across = i == 0 ? first : i == 1 ? first + beside : i == 2 ? first - beside : to_int(floor(expected + 0.5f));
    Int on = row - Int(i == 4 ? 1 : 0);
    Bool look = from.on;
    if (i > 0) look = look && nearest > kNearEnough;
    if (!alike) look = look && !found;
    if (!some(look)) continue;
    Int x = X + select(steep, across, on);
    Int y = Y + select(steep, on, across);
    Real other = piece_at(kind, x, y);
    Bool here = look && is_piece(other) && sure_of(other) > from.least;
    if (!some(here)) continue;
    Real crossed = alike ? to_real(across) + place_of(other) : to_real(across);
    Real away = abs(crossed - expected);
    here = here && away < nearest;
    if (alike) {
      found = found || here;
      next.slope = select(here, slope_of(other), next.slope);
    }
    nearest = select(here, away, nearest);
    next.place = select(here, crossed, next.place);
    next.x = select(here, x, next.x);
    next.y = select(here, y, next.y);
    next.steep = chosen(here, kind, next.steep);
    next.piece = select(here, other, next.piece);
  }
  next.on = from.on && nearest < kAstray;
  return next;
}

// A place on the way along a line that may lack a row (column) here and there.
struct Walk {
  Along at;
  Bool ahead;  // that is one row farther than it was asked for
};

// The next place, `k` rows from pixel (X, Y) to `side`, or the one after that.
FN Walk next_over(Walk from, Int X, Int Y, Bool steep, int k, Int side, Real towards) {
  Along one = from.at;
  one.on = one.on && !from.ahead;
  Along next = next_along(one, X, Y, steep, side * Int(k), towards);
  Bool gap = one.on && !next.on;
  Along last = from.at;
  last.on = (from.ahead && last.on) || next.on;
  if (some(next.on)) last = chosen(next.on, next, last);
  if (some(gap)) {
    one.on = gap;
    one.place = mad(one.slope, towards, one.place);
    Along beyond = next_along(one, X, Y, steep, side * Int(k + 1), towards);
    last = chosen(beyond.on, beyond, last);
    gap = beyond.on;
  }
  return Walk(last, gap);
}

// The next place along a line, also over a gap of a row, or not.
FN Walk walked(Walk from, Int X, Int Y, Bool steep, int k, Int side, Real towards, bool over) {
  if (over) return next_over(from, X, Y, steep, k, side, towards);
  return Walk(next_along(from.at, X, Y, steep, side * Int(k), towards), from.ahead);
}

// Where a line was followed to.
struct Followed {
  Along last;
  Bool ends;  // it does not go on from there
  Int rows;   // rows (columns) to there
};

// The line from a place in pixel (X, Y), to one side, for up to `most` rows and one. over: with gaps of a row.
FN Followed followed(Along from, Int X, Int Y, Bool steep, Int side, Real towards, int most, bool over) {
  Walk walk = Walk(from, from.on && !from.on);
  Int rows = Int(0);
  for (int k = 1; k <= most + 1; ++k) {
    if (!some(walk.at.on)) continue;
    walk = walked(walk, X, Y, steep, k, side, towards, over);
    rows = select(walk.at.on, select(walk.ahead, Int(k + 1), Int(k)), rows);
  }
  return Followed(walk.at, from.on && !walk.at.on, rows);
}

// The middle of the stroke at a place along a line, from pixel (X, Y).
FN Vec2 middle_at(Along here, Int X, Int Y, float width) {
  return middle_of(here.piece, here.steep, width) + Vec2(to_real(here.x - X), to_real(here.y - Y));
}

// Whether the next place along a line, in row `row`, is in the picture: at its border no line ends.
FN Bool goes_inside(Along last, Int X, Int Y, Bool steep, Int row, Real towards) {
  Real expected = mad(last.slope, towards, last.place);
  Int least = to_int(floor(expected - 0.5f));
  Int most = Int(0) - to_int(floor(Real(-0.5f) - expected));
  return in_picture(X + select(steep, least, row), Y + select(steep, row, least)) &&
         in_picture(X + select(steep, most, row), Y + select(steep, row, most));
}

// The way of a line at its end `at`, outward: from the mean of its strokes' middles in the few rows (columns) before
// it, since the end's own piece knows that from too few. 0 where there are none.
FN Vec2 way_of(Bool asked, Int X, Int Y, Real piece, Bool steep, Real towards, Vec2 at, float width) {
  Vec2 sum = Vec2(Real(0.0f), Real(0.0f));
  Real count = Real(0.0f);
  Along before = Along(asked, place_of(piece), slope_of(piece), X, Y, steep, piece, Real(kLeastSeen));
  for (int k = 1; k <= kBefore; ++k) {
    if (!some(before.on)) continue;
    before = next_along(before, X, Y, steep, to_int(-towards * float(k)), -towards);
    Vec2 middle = middle_at(before, X, Y, width);
    sum = chosen(before.on, sum + middle, sum);
    count = select(before.on, count + 1.0f, count);
  }
  Vec2 way = at - sum * (Real(1.0f) / max(count, Real(1.0f)));
  Real length = sqrt(max(dot(way, way), Real(1e-6f)));
  return way * (select(count > 0.0f, Real(1.0f), Real(0.0f)) / length);
}
