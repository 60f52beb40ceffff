// Lines seen over a longer way: how sure each piece of line is, and where it passes. A bevel or a fold is clear in some
// rows and faint in others, as pixels fall on it, so what decides is how much of the line is clear, before and after. A
// line that fades tapers, as a pen's does, and a row of dashes becomes one thin line or none.
//
// From each piece the line is followed in hops, each from where the one before arrived and in the direction that the
// line has there. A rim that leans little, whose place steps once in many rows, is straightened by the same way.
//
// Planes: pieces of line as outline_piece.kernel.h has them; how sure they are is now 0 for nothing to kSure for what
// is to be drawn whole. outline_around is what lies along the row as far as lines may reach, before this pass: 0 for no
// line, below 0 where one ends.
IN_REAL(outline_steep)
IN_REAL(outline_flat)
OUT_REAL(outline_steep_linked)
OUT_REAL(outline_flat_linked)
OUT_REAL(outline_around)
#include "effects/outline/outline_piece.kernel.h"

CONST int kHop = 7;                 // rows: a piece of outline_refine knows three to either side; the first is three
CONST int kHops = 4;                // to either side
CONST float kAstray = 1.1f;         // pixels beside where it is expected, at which a piece is another line's
CONST float kMostTurn = 48.5f;      // of level
CONST float kMostTurnFaint = 4.5f;  // from a rim to a crease, if either is faint
CONST float kMostClearing = 12.5f;  // of how sure: what is wholly faint does not go on in what is wholly clear
CONST float kDiagonal = 0.8f;       // slope from which on a line is made of pieces of both kinds
CONST float kMiddle = 32.0f;        // level of a crease
CONST float kLeastPieces = 3.0f;    // of a crease that is drawn whole; with one it is a speck
CONST float kStraight = 1.05f;      // pixels of bend: what the steps of a straight rim may look like
CONST float kLeastClear = 0.42f;    // share of a line that is clear, below which it is not drawn,
CONST float kWholeClear = 0.75f;    // and from which on it is drawn whole
CONST float kWholeSide = 32.0f;     // from the middle
CONST float kEnds = 12.5f;          // from the middle: a surface ends there, whether a line is drawn or not
CONST float kLeastSure = 1.5f;      // of kSure: what is fainter is not seen
CONST float kUpright = 0.14f;       // slope: seven rows to a step
CONST float kClear = 7.0f;          // half of it
CONST float kSides = 128.0f;        // more than any level
CONST int kAround = 6;              // in high pictures: pixels, times the stride, within which a line has
CONST float kLeastAround = 6.0f;    // pieces, times the stride, or else it is a speck;
CONST float kSpeckPieces = 5.5f;    // which is asked only where fewer pieces than this were found along it

// A piece in row `row`, `rows` after the one before: where it lies beside the first, its slope, and of two that are
// packed into one, how much of it is clear and its side: kSides times the former and the latter; below 0 for none.
FN Vec3 hop(int lying, Int px, Int py, int row, int rows, Vec3 from, Real side) {
  Real slope = from.y;
  Real expected = mad(slope, Real(float(rows)), from.x);
  Real first = floor(expected);
  Bool crease = side == Real(kMiddle);
  Bool alive = from.z >= 0.0f;
  Vec3 best = Vec3(expected, slope, Real(-1.0f));
  Real nearest = Real(kAstray);
  Real beside = select(expected - first < 0.5f, Real(-1.0f), Real(1.0f));
  for (int k = 0; k <= 1; ++k) {
    Int column = to_int(k == 0 ? first : first + beside);
    Int X = lying == 0 ? px + column : px + Int(row);
    Int Y = lying == 0 ? py + Int(row) : py + column;
    Bool here = alive && X >= Int(0) && X < Int(F.width) && Y >= Int(0) && Y < Int(F.height);
    if (!some(here)) continue;
    Real piece = lying == 0 ? load_outline_steep(X, Y) : load_outline_flat(X, Y);
    here = here && is_piece(piece);
    if (!some(here)) continue;
    Real other = level_of(piece);
    here = here && abs(other - side) < kMostTurn;
    Real place = to_real(column) + place_of(piece);
    Real away = abs(place - expected);
    Bool mixed = crease || other == Real(kMiddle);
    Real before = floor(from.z * Real(1.0f / kSides));
    Bool clear = sure_of(piece) > kClear && before >= kClear;
    here = here && (!mixed || clear || abs(other - side) < kMostTurnFaint) && away < nearest;
    here = here && abs(sure_of(piece) - before) < kMostClearing;
    nearest = select(here, away, nearest);
    best =
        select(here, Vec3(place, slope_of(piece), mad(sure_of(piece), Real(kSides), select(mixed, side, other))), best);
  }
  return best;
}

// How many of the pixels in row j of those around have pieces.
FN Real pieces_in(int j, int around) {
  Real count = Real(0.0f);
  for (int i = -around; i <= around; ++i) {
    Bool any = is_piece(near_outline_steep(i, j)) || is_piece(near_outline_flat(i, j));
    count = select(any, count + 1.0f, count);
  }
  return count;
}

// Whether so few pixels around have pieces that this is a speck. All of a stroke that short is in sight from each of
// its pieces, so where nothing else is near it is there or not as a whole.
FN Bool speck_around(Bool asked) {
  int around = kAround * C.stride;
  Real least = Real(kLeastAround * float(C.stride));
  Real count = pieces_in(0, around);
  for (int j = 1; j <= around; ++j)
    if (some(asked && count < least)) count = count + pieces_in(-j, around) + pieces_in(j, around);
  return asked && count < least;
}

// The piece of line at this pixel as its way on either side shows it. Of one that needs no `look`, since it is sure,
// only whether it is a speck.
FN Real linked(int lying, Int px, Int py, Real piece, Bool look) {
  Bool drawn = is_piece(piece);
  Real side = level_of(piece);
  Real place = place_of(piece);
  Vec3 up = Vec3(place, slope_of(piece), select(drawn, mad(sure_of(piece), Real(kSides), side), Real(-1.0f)));
  Vec3 down = up;
  Real slope = up.y;
  Real clear = sure_of(piece);
  Real sides = side;
  Real pieces = Real(1.0f);
  Real pairs = Real(0.0f);
  Real places = Real(0.0f);
  Real moments = Real(0.0f);
  Real squares = Real(0.0f);
  Bool straight = drawn;
  for (int k = 1; k <= kHops; ++k) {
    if (!some((up.z >= 0.0f || down.z >= 0.0f) && (look || pieces < kSpeckPieces))) continue;
    int row = 3 + (k - 1) * kHop;
    int rows = k == 1 ? row : kHop;
    up = hop(lying, px, py, -row, -rows, up, side);
    down = hop(lying, px, py, row, rows, down, side);
    Real up_sure = floor(max(up.z, Real(0.0f)) * Real(1.0f / kSides));
    Real down_sure = floor(max(down.z, Real(0.0f)) * Real(1.0f / kSides));
    clear = clear + up_sure + down_sure;
    sides = sides + max(mad(up_sure, Real(-kSides), up.z), Real(0.0f)) +
            max(mad(down_sure, Real(-kSides), down.z), Real(0.0f));
    pieces = pieces + select(up.z >= 0.0f, Real(1.0f), Real(0.0f)) + select(down.z >= 0.0f, Real(1.0f), Real(0.0f));
    straight = straight && up.z >= 0.0f && down.z >= 0.0f && abs(up.x + down.x - place - place) < kStraight;
    Real counts = select(straight, Real(1.0f), Real(0.0f));
    pairs = pairs + counts;
    places = mad(counts, up.x + down.x, places);
    moments = mad(counts, (down.x - up.x) * Real(float(row)), moments);
    squares = squares + counts * Real(float(2 * row * row));
  }
  Real mean = (places + place) / (pairs + pairs + 1.0f);
  mean = clamp(mean, Real(-0.5f), Real(1.499f));
  slope = select(pairs > 0.5f, moments / max(squares, Real(1.0f)), slope);
  Real share = clear / (pieces * kSure);
  share = clamp((share - kLeastClear) * Real(1.0f / (kWholeClear - kLeastClear)), Real(0.0f), Real(1.0f));
  Real support = clamp((pieces - 1.0f) * Real(1.0f / (kLeastPieces - 1.0f)), Real(0.0f), Real(1.0f));
  share = select(maybe_speck(piece) && abs(slope) < kDiagonal, share * support, share);
  Real sure = floor(share * kSure + 0.5f);
  Bool keep = drawn && (sure > kLeastSure || !look);
  if (C.stride > 1) {
    Bool lonely = keep && pieces < kSpeckPieces;
    if (some(lonely)) keep = keep && !speck_around(lonely);
  }
  Real found = packed_piece(mean, slope, floor(sides / pieces + 0.5f), sure);
  Real instead = select(abs(side - kMiddle) > kEnds, Real(kOnlyEnds), Real(0.0f));
  return select(keep, select(piece < 0.0f, -found, found), instead);
}

// Whether a piece of line cannot be told from itself: it is a crease, or not wholly clear, or lies partly on either
// side, or is so nearly upright that its steps are far apart.
FN Bool unsure(Real piece) {
  Bool whole = abs(level_of(piece) - kMiddle) > kWholeSide - 0.5f && bits_at(piece, 23, Uint(31u)) == Real(kSure);
  return is_piece(piece) && !(whole && abs(slope_of(piece)) >= kUpright);
}

FN Real looked_along(int lying, Int px, Int py, Real piece) {
  Bool look = unsure(piece);
  Bool asked = C.stride > 1 ? is_piece(piece) : look;
  if (!some(asked)) return piece;
  Real found = linked(lying, px, py, select(asked, piece, Real(0.0f)), look);
  return select(look || (asked && !is_piece(found)), found, piece);
}

// All bits of the pieces along this row as far as lines may reach.
FN Real pieces_around(int sight) {
  Uint any = Uint(0u);
  for (int i = -sight; i <= sight; ++i)
    any = any | bits_of(near_outline_steep(i, 0)) | bits_of(near_outline_flat(i, 0));
  return real_of_bits(any);
}

FN void outline_link_pixel(Int px, Int py) {
  Real steep = near_outline_steep(0, 0);
  Real lower = near_outline_flat(0, 0);
  store_outline_around(C.sight == kOutlineUsualSight ? pieces_around(kOutlineUsualSight) : pieces_around(C.sight));
  if (some(is_piece(steep))) steep = looked_along(0, px, py, steep);
  if (some(is_piece(lower))) lower = looked_along(1, px, py, lower);
  store_outline_steep_linked(steep);
  store_outline_flat_linked(lower);
}
