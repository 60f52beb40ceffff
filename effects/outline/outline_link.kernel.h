// Lines seen over a longer way: how sure each piece of line is, and where it passes. A bevel or a fold is clear in some
// rows and faint in others, as pixels fall on it, so what decides is how much of the line is clear, before and after,
// and how far it goes. A line that fades tapers, as a pen's does, and a row of dashes becomes one thin line or none.
//
// From each piece that is not sure the line is followed row by row, so that the next piece sees nearly the same rows
// and fades alike; each step goes on from where the one before arrived and in the direction that the line has there. A
// sure rim that leans little, whose place steps once in many rows, or that lies partly on either side is evened by hops
// of several rows.
//
// Planes: pieces of line as outline_piece.kernel.h has them; how sure they are is now 0 for nothing to kSure for what
// is to be drawn whole.
IN_REAL(outline_steep)
IN_REAL(outline_flat)
OUT_REAL(outline_steep_linked)
OUT_REAL(outline_flat_linked)
#include "effects/outline/outline_piece.kernel.h"

CONST int kRows = 9;                  // times the stride,
CONST int kMoreRows = 5;              // and these: how far a line is followed that is not sure, to either side
CONST float kWholeRows = 9.0f;        // times the stride: of how many rows it is drawn whole,
CONST float kLeastRows = 3.0f;        // and of how many not at all;
CONST float kMeetingRows = 4.5f;      // and for how many an end counts at which it meets another line
CONST float kMeetingTimes = 3.0f;     // at most so many times the rows but one: a step of another line is none
CONST float kMostGap = 1.5f;          // more than the stride: from so many rows without a piece on it ends
CONST int kFirstHop = 3;              // rows: a piece of outline_refine knows three to either side
CONST int kHop = 7;                   // rows, of the ones after it,
CONST int kHops = 4;                  // to either side
CONST float kNearEnough = 0.4f;       // pixels beside, at which no other piece is looked for
CONST float kAstray = 1.1f;           // pixels beside where it is expected, at which a piece is another line's
CONST float kMostTurn = 48.5f;        // of level
CONST float kMostTurnFaint = 4.5f;    // from a rim to a crease, if either is faint
CONST float kMostClearing = 12.5f;    // of how sure: what is wholly faint does not go on in what is wholly clear
CONST float kMiddle = 32.0f;          // level of a crease
CONST float kStraight = 1.05f;        // pixels of bend: what the steps of a straight rim may look like
CONST float kStraightCrease = 0.35f;  // and a crease, which has none
CONST float kLeastClear = 0.42f;      // share of a line that is clear, below which it is not drawn,
CONST float kWholeClear = 0.75f;      // and from which on it is drawn whole
CONST float kWholeSide = 32.0f;       // from the middle
CONST float kEnds = 12.5f;            // from the middle: a surface ends there, whether a line is drawn or not
CONST float kLeastSure = 1.5f;        // of kSure: what is fainter is not seen,
CONST int kSeenBits = 0x07000000;     // and what is surer has one of these bits
CONST float kUpright = 0.14f;         // slope: seven rows to a step
CONST float kClear = 7.0f;            // half of it,
CONST int kClearBits = 0x04000000;    // and what is surer has this bit
CONST int kRimRows = 6;               // rows, per pixel of stride, from a rim, within which a crease leans to its side
CONST float kPartlyRim = 8.0f;        // of level, from the middle, of a rim that a crease leans to; what
                                      // has no more rows than the stride is of one that it meets
CONST float kBetween = 0.5f;          // pixels: what a rim's place is known by
CONST float kSameWay = 0.2f;          // between the slopes of a crease and a rim that it goes on in
CONST int kMeets = 3;                 // pixels beside a line's end, within which it meets one that runs its way
CONST int kTurns = 1;                 // and one that runs across
CONST int kAround = 6;                // pixels, times the stride, within which a line has
CONST float kLeastAround = 6.5f;      // pieces, times the stride, or else it is a speck
CONST int kGapWithin = 2;             // pixels between two parts of what may be small,
CONST int kApartFrom = 3;             // and around it, within which no other thing is
CONST int kSweeps = 6;                // over what is around, to find all of it: most take two

// The way along a line from a piece of it, to one side.
struct Way {
  Bool on;            // it goes on
  Real place, slope;  // of its last piece: beside the first one, and how it leans
  Real sure, level;   // of that
  Real row;           // of that, counted from the first
  Real rims;          // so many rows of a rim that a crease goes on in,
  Real leans;         // and how far it leans to that by where the first of them is
  Real rim;           // of the rim that a crease goes on in, level less the middle's, less by that
};

// What was seen along a line.
struct Line {
  Way up, down;
  Real rows, found;                      // that it goes on, and those of them that have pieces, or a hop's piece
  Real clear, sides;                     // sums of their pieces' sure_of and level_of
  Real pairs, places, moments, squares;  // of pieces as far up as down, for as long as it is straight
};

// The way on to row `row`, which is so many `rows` away.
FN Way gone_on(int lying, Int px, Int py, int row, int rows, Way from, Real side, Real most_gap) {
  Way next = from;
  Real away_rows = Real(float(rows)) - from.row;
  Real expected = mad(row < 0 ? -from.slope : from.slope, away_rows, from.place);
  Real first = floor(expected + kHalfway);
  Bool crease = side == Real(kMiddle);
  Bool found = from.on && !from.on;
  Real nearest = Real(kAstray);
  Real rim = Real(0.0f);
  Real aside = rim;  // how far the rim is beyond where the crease is expected
  Real beside = select(expected + kHalfway - first < 0.5f, Real(-1.0f), Real(1.0f));
  for (int k = 0; k <= 2; ++k) {
    Int column = to_int(k == 0 ? first : k == 1 ? first + beside : first - beside);
    Int X = lying == 0 ? px + column : px + Int(row);
    Int Y = lying == 0 ? py + Int(row) : py + column;
    Bool here = from.on && in_picture(X, Y);
    if (k > 0) here = here && nearest > kNearEnough;
    if (!some(here)) continue;
    Real piece = lying == 0 ? load_outline_steep(X, Y) : load_outline_flat(X, Y);
    here = here && is_piece(piece);
    if (!some(here)) continue;
    Real other = level_of(piece);
    Real sure = sure_of(piece);
    Real turn = abs(other - side);
    Real place = to_real(column) + place_of(piece);
    Real away = abs(place - expected);
    Bool mixed = crease || other == Real(kMiddle);
    Bool clear = sure > kClear && from.sure >= kClear;
    here = here && turn < kMostTurn && (!mixed || clear || turn < kMostTurnFaint) && away < nearest;
    here = here && abs(sure - from.sure) < kMostClearing;
    nearest = select(here, away, nearest);
    next.place = select(here, place, next.place);
    next.slope = select(here, slope_of(piece), next.slope);
    next.sure = select(here, sure, next.sure);
    next.level = select(here, select(mixed, side, other), next.level);
    Bool onward = mixed && abs(other - side) > kPartlyRim && abs(slope_of(piece) - from.slope) < kSameWay;
    rim = select(here, select(onward, other - side, Real(0.0f)), rim);
    // The rim's line lies beside its place: it leans so much less as that is surely beyond the crease's.
    Real beyond = select(other > side, place - expected, expected - place);
    aside = select(here, max(beyond - kBetween, Real(0.0f)), aside);
    found = found || here;
  }
  next.rims = select(found && abs(rim) > 0.0f, from.rims + 1.0f, select(found, Real(0.0f), from.rims));
  Real near = max(Real(1.0f) - Real(float(rows) / float(kRimRows * C.stride)), Real(0.0f));
  Real wide = Real(2.0f / (C.width_px > 1.0f ? C.width_px : 1.0f));
  next.leans = select(from.rims < 0.5f, near * max(Real(1.0f) - aside * wide, Real(0.0f)), from.leans);
  rim = rim * next.leans;
  next.rim = select(found && crease && next.rims > Real(float(C.stride)) && from.rim == Real(0.0f), rim, next.rim);
  next.on = found || (from.on && away_rows < most_gap);
  next.row = select(found, Real(float(rows)), next.row);
  return next;
}

// The line through a piece: `near` steps of a row, and `hops` hops, the first of them to row `first`. What can no
// longer become clear enough is not followed to its end.
FN Line followed(int lying, Int px, Int py, Real piece, Bool asked, int near, int first, int hops) {
  Real side = level_of(piece);
  Real place = place_of(piece);
  Real sure = sure_of(piece);
  Real none = Real(0.0f);
  Way way = Way(asked, place, slope_of(piece), sure, side, none, none, none, none);
  Line line = Line(way, way, Real(1.0f), Real(1.0f), sure, side, none, none, none, none);
  Bool straight = asked;
  Real bend = select(side == Real(kMiddle), Real(kStraightCrease), Real(kStraight));
  int before = 0;
  for (int k = 0; k < near + hops; ++k) {
    Bool on = line.up.on || line.down.on;
    if (k < near) {
      Real ahead = Real(float(2 * (near - k)));
      on = on && mad(ahead, Real(kSure * (1.0f - kLeastClear)), line.clear) > line.rows * (kSure * kLeastClear);
      line.up.on = line.up.on && on;
      line.down.on = line.down.on && on;
    }
    if (!some(on)) continue;
    int row = k < near ? k + 1 : first + (k - near) * kHop;
    Real most_gap = Real(k < near ? kMostGap + float(C.stride) : 0.0f);
    Real up_row = line.up.row;
    Real down_row = line.down.row;
    line.up = gone_on(lying, px, py, -row, row, line.up, side, most_gap);
    line.down = gone_on(lying, px, py, row, row, line.down, side, most_gap);
    Bool up_found = line.up.row > up_row;
    Bool down_found = line.down.row > down_row;
    // A hop's piece stands for those that it passes over; what is not there counts, too.
    Real stands_for = Real(float(row - before));
    Real up = select(up_found, stands_for, none);
    Real down = select(down_found, stands_for, none);
    line.rows = line.rows + (line.up.row - up_row) + (line.down.row - down_row);
    line.clear = mad(up, line.up.sure, mad(down, line.down.sure, line.clear));
    line.found = line.found + up + down;
    line.sides = mad(up, line.up.level, mad(down, line.down.level, line.sides));
    Bool both = up_found && down_found;
    Bool bent = both && !(abs(line.up.place + line.down.place - place - place) < bend);
    straight = straight && line.up.on && line.down.on && !bent;
    // Of the first rows outline_refine has the mean.
    Real counts = select(straight && both, row < kFirstHop ? none : stands_for, none);
    line.pairs = line.pairs + counts;
    line.places = mad(counts, line.up.place + line.down.place, line.places);
    line.moments = mad(counts, (line.down.place - line.up.place) * Real(float(row)), line.moments);
    line.squares = line.squares + counts * Real(float(2 * row * row));
    before = row;
  }
  return line;
}

// Whether a line meets another one, or turns and goes on in pieces of the other kind, where it has none of its own in
// row `row` at `place`. towards: the way along it, -1 or 1.
FN Bool meets(int lying, Int px, Int py, Bool asked, Int row, int towards, Real place) {
  Bool found = asked && !asked;
  if (!some(asked)) return found;
  Int first = to_int(floor(place));
  for (int j = -kTurns - 1; j <= kTurns; ++j)
    for (int i = -kMeets; i <= kMeets; ++i) {
      Int X = lying == 0 ? px + first + Int(i) : px + row + Int(j);
      Int Y = lying == 0 ? py + row + Int(j) : py + first + Int(i);
      Bool here = asked && !found && in_picture(X, Y);
      if (!some(here)) continue;
      Bool met = here && !here;
      if (i >= -kTurns && i <= kTurns + 1) {
        Real across = lying == 0 ? load_outline_flat(X, Y) : load_outline_steep(X, Y);
        met = is_piece(across) && sure_of(across) > kClear;
      }
      if (j * towards >= 0 && j * towards <= kTurns) {
        Real along = lying == 0 ? load_outline_steep(X, Y) : load_outline_flat(X, Y);
        met = met || (is_piece(along) && sure_of(along) > kClear);
      }
      found = found || (here && met);
    }
  return found;
}

// How many of the pixels in row j of those around have pieces.
FN Real pieces_in(int j, int around) {
  Real count = Real(0.0f);
  for (int i = -around; i <= around; ++i) {
    Bool any = has_piece(bits_of(near_outline_steep(i, j)) | bits_of(near_outline_flat(i, j)));
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

// A rectangle around this pixel's piece, with all pieces that are no farther from it than kGapWithin.
struct Within {
  Real first, last, top, bottom;
};

FN Bool is_within(Within all, int i, int j, float margin) {
  Real x = Real(float(i));
  Real y = Real(float(j));
  return x >= all.first - margin && x <= all.last + margin && y >= all.top - margin && y <= all.bottom + margin;
}

// Whether a piece of a pixel nearby has any of these bits.
FN Bool has_any_bit(int i, int j, Uint bits) {
  Uint both = bits_of(near_outline_steep(i, j)) | bits_of(near_outline_flat(i, j));
  return !(to_signed(both & bits) == Int(0));
}

FN Bool is_seen_near(int i, int j) { return has_any_bit(i, j, Uint(kSeenBits)); }
FN Bool is_clear_near(int i, int j) { return has_any_bit(i, j, Uint(kClearBits)); }

// Whether what this piece is part of is smaller than C.small pixels in both directions, with no other near it: it would
// be all line. All pieces of one outline see the same, so that it is there or not as a whole.
FN_RARE Bool small_around(Bool asked) {
  Bool small = asked;
  Real zero = Real(0.0f);
  Within all = Within(zero, zero, zero, zero);
  // From this row on outward, until nothing is added, since what is farther may lead back.
  Bool grows = asked;
  int reach = C.small + kGapWithin;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    if (!some(small && grows)) continue;
    Real before = all.last - all.first + all.bottom - all.top;
    for (int k = 0; k < 2 * reach + 1; ++k) {
      if (!some(small)) continue;
      int j = k % 2 == 0 ? -(k / 2) : (k + 1) / 2;
      for (int i = -reach; i <= reach; ++i) {
        Bool any = is_seen_near(i, j);
        Bool part = any && is_within(all, i, j, float(kGapWithin));
        all.first = select(part, min(all.first, Real(float(i))), all.first);
        all.last = select(part, max(all.last, Real(float(i))), all.last);
        all.top = select(part, min(all.top, Real(float(j))), all.top);
        all.bottom = select(part, max(all.bottom, Real(float(j))), all.bottom);
      }
      Real most = Real(float(C.small));
      small = small && all.last - all.first < most && all.bottom - all.top < most;
    }
    grows = all.last - all.first + all.bottom - all.top > before;
  }
  int wide = C.small + kApartFrom;
  for (int j = -wide; j <= wide; ++j) {
    if (!some(small)) continue;
    for (int i = -wide; i <= wide; ++i) {
      Bool other = is_clear_near(i, j) && is_within(all, i, j, float(kApartFrom)) && !is_within(all, i, j, 0.0f);
      small = small && !other;
    }
  }
  return small;
}

// How many pieces what would be all line has at most, to be asked for.
FN float most_of_small() {
  float most = kLeastAround * float(C.stride);
  return most > 2.0f * float(C.small) ? most : 2.0f * float(C.small);
}

// A piece with the place and the slope of its line, as far as that is straight, and the mean of its sides. A crease
// that goes on in a rim leans to that one's side the more the nearer that is, lest the line step aside there.
FN Real straightened(Real piece, Line line, Real sure) {
  Real mean = (line.places + place_of(piece)) / (line.pairs + line.pairs + 1.0f);
  mean = clamp(mean, Real(-0.5f), Real(1.499f));
  Real slope = select(line.pairs > 0.5f, line.moments / max(line.squares, Real(1.0f)), slope_of(piece));
  Real level = clamp(line.sides / line.found + line.up.rim + line.down.rim, Real(0.0f), Real(kMiddle + kWholeSide));
  Real found = packed_piece(mean, slope, floor(level + kRounds), sure);
  found = select(abs(line.up.rim) > 0.0f || abs(line.down.rim) > 0.0f, leaning(found), found);
  return select(piece < 0.0f, -found, found);
}

// A piece that is not sure, as its line shows it.
FN Real weighed(int lying, Int px, Int py, Real piece, Bool asked) {
  Line line = followed(lying, px, py, piece, asked, kRows * C.stride + kMoreRows, 0, 0);
  Real share = line.clear / (line.rows * kSure);
  share = clamp((share - kLeastClear) * Real(1.0f / (kWholeClear - kLeastClear)), Real(0.0f), Real(1.0f));
  // What is short is less sure, unless it is so between other lines.
  Real stride = Real(float(C.stride));
  Real rows = line.found;
  Bool brief = asked && rows < stride * kWholeRows && share > 0.0f;
  if (some(brief)) {
    Bool above =
        meets(lying, px, py, brief && !line.up.on, -to_int(line.up.row) - Int(1), -1, line.up.place - line.up.slope);
    Bool below = meets(lying, px, py, brief && !line.down.on, to_int(line.down.row) + Int(1), 1,
                       line.down.place + line.down.slope);
    Real more = min(stride * kMeetingRows, (rows - 1.0f) * kMeetingTimes);
    rows = select(above, rows + more, rows);
    rows = select(below, rows + more, rows);
  }
  rows = (rows - stride * kLeastRows) / (stride * (kWholeRows - kLeastRows));
  Real sure = floor(share * clamp(rows, Real(0.0f), Real(1.0f)) * kSure + kRounds);
  Bool kept = asked && sure > kLeastSure;
  brief = kept && line.found < stride * kLeastAround;
  if (some(brief)) kept = kept && !speck_around(brief);
  brief = kept && line.found < most_of_small();
  if (some(brief)) kept = kept && !small_around(brief);
  return select(kept, straightened(piece, line, sure), Real(0.0f));
}

// Whether a piece of line cannot be told from itself: it is not wholly clear, or a crease, or, in high pictures, where
// more rows even it out, it lies partly on either side.
FN Bool unsure(Real piece) {
  Real off = abs(level_of(piece) - kMiddle);
  return off < (C.stride > 1 ? kWholeSide - 0.5f : 0.5f) || sure_of(piece) < kSure;
}

// Whether a piece that is sure has a better place, or side, by those of its line: it is nearly upright, so that its
// steps are far apart, or lies partly on either side.
FN Bool uneven(Real piece) {
  Real off = abs(level_of(piece) - kMiddle);
  return abs(slope_of(piece)) < kUpright || (off > 0.5f && off < kWholeSide - 0.5f);
}

// A piece that is sure: evened where that is better. Whether it is part of anything is asked of all in high pictures,
// and else of what outline_refine found short.
FN Real confirmed(int lying, Int px, Int py, Real piece, Bool asked) {
  Bool better = asked && uneven(piece);
  Bool brief = asked;
  Bool walked = asked;
  if (C.stride == 1) {
    brief = brief && maybe_speck(piece);
    walked = better;
  }
  Line line = followed(lying, px, py, piece, walked, 0, kFirstHop, kHops);
  piece = select(better, straightened(piece, line, sure_of(piece)), without_mark(piece));
  // What goes on in what is faint may be small none the less.
  Bool small = brief && line.clear < Real(kSure * most_of_small());
  brief = brief && line.found < Real(kLeastAround * float(C.stride));
  if (some(brief)) piece = select(speck_around(brief), Real(0.0f), piece);
  if (some(small)) piece = select(small_around(small), Real(0.0f), piece);
  return piece;
}

FN Real looked_along(int lying, Int px, Int py, Real piece) {
  Bool drawn = is_piece(piece);
  Bool look = drawn && unsure(piece);
  Real found = piece;
  if (some(look)) found = select(look, weighed(lying, px, py, piece, look), found);
  Bool rest = drawn && !look;
  if (C.stride == 1) rest = rest && (maybe_speck(piece) || uneven(piece));
  if (some(rest)) found = select(rest, confirmed(lying, px, py, piece, rest), found);
  // What is faint is not the end of a surface: it would cut wide lines.
  Bool ends = abs(level_of(piece) - kMiddle) > kEnds && sure_of(piece) > kClear;
  Real instead = select(ends, Real(kOnlyEnds), Real(0.0f));
  return select(drawn && !is_piece(found), instead, found);
}

FN void outline_link_pixel(Int px, Int py) {
  Real steep = near_outline_steep(0, 0);
  Real lower = near_outline_flat(0, 0);
  if (some(is_piece(steep))) steep = looked_along(0, px, py, steep);
  if (some(is_piece(lower))) lower = looked_along(1, px, py, lower);
  store_outline_steep_linked(steep);
  store_outline_flat_linked(lower);
}
