// The crossings of outline_find joined into smooth lines. A rim is known only to lie between two pixels; where it
// passes follows from how it steps from row to row: the mean of its places in as many rows above as below lies on the
// line, to about one part in the number of rows. So is its side. Sharp creases were found exactly and only get their
// direction.
//
// Crossings of one kind (to the right) make lines that are steeper than 45 degrees, those of the other (below) flat
// ones. A crossing that has no neighbour in the next row on either side is a step of a line of the other kind and is
// dropped where that line is there.
//
// Planes, for crossings to the right and below: pieces of line as outline_piece.kernel.h has them.
IN_REAL(outline_right_settled)
IN_REAL(outline_below_settled)
OUT_REAL(outline_steep)
OUT_REAL(outline_flat)
#include "effects/outline/outline_crossing.kernel.h"
#include "effects/outline/outline_piece.kernel.h"

CONST int kRows = 3;                // on each side: the place is then known to about a seventh of a pixel
CONST float kSteepHere = 1.05f;     // from here on the other kind of crossing knows the line better
CONST float kUpright = 0.3f;        // slope of steps of two lines, one below the other
CONST float kLeastLength = 2.5f;    // rows that a crease goes on
CONST float kOneSided = 25.0f;      // from the middle: a surface ends there
CONST int kBeside = 4;              // pixels from a clear crossing within which a faint one may run along with it,
CONST int kShadow = 2;              // and within which it is but that one's shadow
CONST float kNoShadow = 2.5f;       // how clear a faint crease is that is none: outline_find's kHidden, not its kNarrow
CONST float kPart = 1.25f;          // pixels from something clearer, within which a crossing is a part of that, and
CONST float kPartShort = 2.25f;     // if it is short, or where strides are longer: as far as that one's line covers it,
CONST float kRoomBeside = 0.25f;    // pixels that are to be left between two lines, of which one is hidden in part
CONST float kCovers = 0.5f;         // which is its width less this
CONST int kBesideHigh = 14;         // pixels looked at in high pictures, where a soft crease
CONST float kGap = 0.8f;            // with less than this, times the stride, between its line and a clearer one
CONST float kCrowded = 0.25f;       // is that much as sure,
CONST float kWideGap = 2.0f;        // and with this and more as sure as elsewhere
CONST float kSharp = 6.5f;          // from here on a crease is none that is soft
CONST float kBesideRim = 3.0f;      // pixels from a rim, within which a crease rather goes on in creases
CONST float kMostTurn = 97.0f;      // of side, as 1 + 2 level: three quarters of the whole range
CONST float kMostTurnFaint = 9.0f;  // from a rim to a crease, if either is faint

// t from its code.
FN Real crossed_at(Real fraction) { return fraction + fraction - 0.5f; }
FN Real place_in(Real v) { return crossed_at(code_of(v) - floor(code_of(v))); }

// Whether a crossing can go on from one of side `side`: a line does not change from one surface's side to the other's
// from one row to the next, and a faint crease is not the rim that it runs beside.
FN Bool same_line(Real v, Real side, Bool clear) {
  Real other = floor(code_of(v));
  Bool alike = !(other == Real(kMiddle)) && !(side == Real(kMiddle));
  Real most = select(alike || (clear && v > 0.0f), Real(kMostTurn), Real(kMostTurnFaint));
  return abs(v) > 0.0f && abs(other - side) < most;
}

// Whether a crossing is a crease as one of side `side` is, or a jump as that is.
FN Bool of_one_kind(Real v, Real side) {
  Bool crease = floor(code_of(v)) == Real(kMiddle);
  Bool other = side == Real(kMiddle);
  return (crease && other) || !(crease || other);
}

// Whether a line may go on in this crossing, though one is a jump and the other a crease: where there is nothing else,
// and it is not wholly faint.
FN Bool may_join(Real v, Real side) { return abs(v) >= kStep && abs(floor(code_of(v)) - side) < kMostTurn; }

FN Bool faint_crease(Real v) { return v < 0.0f && floor(code_of(v)) == Real(kMiddle); }

// The crossing in row `row` (column, for flat lines) at most one pixel beside `offset` that has about the same side, or
// else 0: its code; how far beside. Straight on comes before aside, and of both sides the clearer one, but no faint
// crease before a clear one.
FN Vec2 follow(int lying, int row, Real offset, Bool alive, Real side, Bool clear, Bool mixes, Bool lone, Bool pure) {
  int most = row < 0 ? -row : row;
  Real straight = Real(0.0f);
  Real after = Real(0.0f);
  Real before = Real(0.0f);
  // The row before was at most one pixel less aside.
  for (int k = 1 - most; k < most; ++k) {
    Bool here = offset == Real(float(k));
    straight =
        select(here, lying == 0 ? near_outline_right_settled(k, row) : near_outline_below_settled(row, k), straight);
    after = select(here, lying == 0 ? near_outline_right_settled(k + 1, row) : near_outline_below_settled(row, k + 1),
                   after);
    before = select(here, lying == 0 ? near_outline_right_settled(k - 1, row) : near_outline_below_settled(row, k - 1),
                    before);
  }
  alive = alive && (lying == 0 ? near_inside(0, row) : near_inside(row, 0));
  Bool back = same_line(before, side, mixes);
  Bool on = same_line(after, side, mixes);
  Bool ahead = same_line(straight, side, mixes);
  Bool clear_back = clear && back && before > 0.0f;
  back = back && (of_one_kind(before, side) || !pure);
  on = on && (of_one_kind(after, side) || !pure);
  ahead = ahead && (of_one_kind(straight, side) || !pure);
  on = on && !(clear_back && faint_crease(after));
  ahead = ahead && !((clear_back || (clear && on && after > 0.0f)) && faint_crease(straight));
  // Like goes on in like that is as clear, also aside.
  Bool like_back = back && of_one_kind(before, side);
  Bool like_on = on && of_one_kind(after, side);
  Bool like_ahead = ahead && of_one_kind(straight, side);
  Bool back_wins =
      like_back && clear_of(before) >= clear_of(straight) && (like_on || !on || clear_of(before) >= clear_of(after));
  Bool on_wins =
      like_on && clear_of(after) >= clear_of(straight) && (like_back || !back || clear_of(after) >= clear_of(before));
  ahead = ahead && (like_ahead || !(back_wins || on_wins));
  back = back && (like_back || !(like_on && clear_of(after) >= clear_of(before)));
  on = on && (like_on || !(like_back && clear_of(before) >= clear_of(after)));
  Bool none = lone && !(back || on || ahead);
  back = back || (none && may_join(before, side));
  on = on || (none && may_join(after, side));
  ahead = ahead || (none && may_join(straight, side));
  on = on && !(back && clear_of(before) > clear_of(after));
  Real found = select(ahead, straight, select(on, after, select(back, before, Real(0.0f))));
  Real beside = select(ahead || !(on || back), Real(0.0f), select(on, Real(1.0f), Real(-1.0f)));
  return Vec2(select(alive, found, Real(0.0f)), offset + beside);
}

FN Real refined(int lying, Real signed_v, Real w0, Real w1, Real w2, Real w3) {
  Real v = code_of(signed_v);
  Real side = floor(v);
  Real t = crossed_at(v - side);
  Bool clear = signed_v > 0.0f;
  // Beside a clear crossing a faint one is its shadow, unless the clear one is a crease and the faint one a rim farther
  // off, or the faint one a crease of which the clear one's object hides a part. What runs beside one goes on in its
  // like alone. Of a crease and a jump that are close the less clear one is a part of the other: of two as clear, the
  // crease.
  Bool rim = abs(side - kMiddle) > kOneSided;
  Bool crease = side == Real(kMiddle);
  Bool beside = v < 0.0f;
  Bool shadow = beside;
  Real least = clear_of(signed_v) + select(crease, Real(-0.5f), Real(0.5f));
  Real nearest = Real(1e30f);  // clear crossing of the other sort that it may be a part of, in pixels
  Bool covered = crease && !crease;
  if (some(v > 0.0f && (crease || least < kClearest))) {
    int farthest = C.stride > 1 ? kBesideHigh : kBeside;
    for (int k = 1; k <= farthest; ++k) {
      Real before = lying == 0 ? near_outline_right_settled(-k, 0) : near_outline_below_settled(0, -k);
      Real after = lying == 0 ? near_outline_right_settled(k, 0) : near_outline_below_settled(0, k);
      Real before_off = abs(code_of(before) - kMiddle);
      Real after_off = abs(code_of(after) - kMiddle);
      if (k <= kBeside) {
        beside = beside || (before > 0.0f && (before_off > kOneSided + 1.0f || !rim));
        beside = beside || (after > 0.0f && (after_off > kOneSided + 1.0f || !rim));
      }
      if (k > kShadow && C.stride == 1) continue;
      if (k <= kShadow) shadow = beside;
      Real before_away = t - place_in(before) + Real(float(k));
      Real after_away = place_in(after) - t + Real(float(k));
      Bool other_before = (crease && before_off > 1.0f) || (!crease && before_off < 1.0f);
      Bool other_after = (crease && after_off > 1.0f) || (!crease && after_off < 1.0f);
      other_before = other_before && before > 0.0f && clear_of(before) > least;
      other_after = other_after && after > 0.0f && clear_of(after) > least;
      nearest = min(nearest, select(other_before, before_away, nearest));
      nearest = min(nearest, select(other_after, after_away, nearest));
      // As far as those lines reach to here.
      if (C.stride > 1) {
        Real reach_before =
            mad(kMiddle - floor(code_of(before)), Real(0.5f / (kMiddle - 1.0f)), Real(0.5f)) * C.width_px;
        Real reach_after = mad(floor(code_of(after)) - kMiddle, Real(0.5f / (kMiddle - 1.0f)), Real(0.5f)) * C.width_px;
        covered = covered || (other_before && before_away < min(reach_before, Real(kPartShort)));
        covered = covered || (other_after && after_away < min(reach_after, Real(kPartShort)));
      }
    }
  }
  // Where a rim goes on beside it a crease goes on in one only if there is no other crease.
  Bool mixes = clear && !(crease && nearest < kBesideRim);
  Bool lone = clear || (!beside && abs(signed_v) >= kStep);
  // Such a crease goes on in creases alone: a rim beside it that hardly lies in front is not itself.
  shadow = shadow && !clear;
  Bool pure = shadow && crease && clear_of(signed_v) > kNoShadow;
  shadow = shadow && !pure;
  Bool exact = !(t == Real(0.5f));
  Bool up_alive = v > 0.0f;
  Bool down_alive = v > 0.0f;
  Vec2 up = Vec2(Real(0.0f), Real(0.0f));  // code and offset in the rows above and
  Vec2 down = up;                          // below
  Real places = Real(0.0f);                // sum over pairs of rows
  Real sides = Real(0.0f);
  Real pairs = Real(0.0f);
  Real moments = Real(0.0f);  // for the slope
  Real squares = Real(0.0f);
  Real one_sided = Real(0.0f);
  Real length = Real(0.0f);          // rows in which the line goes on, and
  Real clears = clear_of(signed_v);  // how clear it is there and here
  Bool joined = up_alive && !up_alive;
  Bool both = up_alive;
  Bool ends = !up_alive;
  for (int k = 1; k <= kRows; ++k) {
    if (!some(up_alive || down_alive)) continue;
    up = follow(lying, -k, up.y, up_alive, side, clear, mixes, lone, pure);
    down = follow(lying, k, down.y, down_alive, side, clear, mixes, lone, pure);
    up_alive = abs(up.x) > 0.0f;
    down_alive = abs(down.x) > 0.0f;
    Real up_code = code_of(up.x);
    Real down_code = code_of(down.x);
    Real up_side = floor(up_code);
    Real down_side = floor(down_code);
    Real up_place = up.y + crossed_at(up_code - up_side);
    Real down_place = down.y + crossed_at(down_code - down_side);
    length = length + select(up_alive, Real(1.0f), Real(0.0f)) + select(down_alive, Real(1.0f), Real(0.0f));
    clears = clears + clear_of(up.x) + clear_of(down.x);
    if (k == 1) {
      joined = up_alive || down_alive;
      ends = !(up_alive && down_alive);
    }
    one_sided = select(up_alive, (t - up_place) * Real(1.0f / float(k)),
                       select(down_alive, (down_place - t) * Real(1.0f / float(k)), one_sided));
    // Rows count in pairs, lest the mean be known to one side.
    both = both && up_alive && down_alive;
    sides = sides + select(both, up_side + down_side, Real(0.0f));
    places = places + select(both, up_place + down_place, Real(0.0f));
    pairs = pairs + select(both, Real(1.0f), Real(0.0f));
    moments = moments + select(both, (down_place - up_place) * Real(float(k)), Real(0.0f));
    squares = squares + select(both, Real(float(2 * k * k)), Real(0.0f));
  }
  // A line that goes on for all rows is no speck; outline_link asks the others.
  Bool short_line = length < Real(float(2 * kRows));
  Real mean = (places + t) / (pairs + pairs + 1.0f);
  Real level = floor(((sides + side) / (pairs + pairs + 1.0f) - 1.0f) * 0.5f + 0.5f);
  // In the middle lie creases alone.
  level = select(!crease && level + level + 1.0f == Real(kMiddle), select(side < kMiddle, level - 1.0f, level + 1.0f),
                 level);
  Real slope = select(squares > 0.0f, moments / max(squares, Real(1.0f)), one_sided);
  // A rim passes between the two pixels, also where its neighbours turn around a corner.
  Real place = clamp(mean, select(exact, Real(-0.5f), Real(0.0f)), select(exact, Real(1.499f), Real(1.0f)));
  // A step of a line of the other kind has its next ones a pixel or more aside, and soon none.
  Bool aside = (!joined || abs(slope) > 0.75f) && pairs < 1.5f && length < kLeastLength;
  // Or that of one beside it, with which it would make a line across both: it leads from the one side to the other.
  Bool across = (abs(w2) > 0.0f && abs(w1) > 0.0f) || (abs(w3) > 0.0f && abs(w0) > 0.0f);
  aside = aside || abs(slope) > kSteepHere || (across && length < kLeastLength && abs(slope) < kUpright);
  Bool step = aside && (abs(w0) + abs(w1) + abs(w2) + abs(w3) > 0.0f);
  Bool speck = abs(side - kMiddle) < kOneSided && length < kLeastLength;  // of a crease
  Real part_within = min(select(short_line, Real(kPartShort), Real(kPart)), Real(C.width_px - kCovers));
  part_within = select(pure, Real(C.width_px + kRoomBeside), part_within);
  Bool part = nearest < part_within || (covered && crease && !pure);
  Bool keep = v > 0.0f && !step && !speck && !shadow && !part;
  Bool known = keep || (v > 0.0f && rim && clear && !shadow);
  Real sure = floor(clears / (length + 1.0f) * Real(kSure / kClearest) + kRounds);
  if (C.stride > 1) {
    Real room = (nearest - (C.width_px + kGap * float(C.stride))) * Real(1.0f / ((kWideGap - kGap) * float(C.stride)));
    room = mad(clamp(room, Real(0.0f), Real(1.0f)), Real(1.0f - kCrowded), Real(kCrowded));
    sure = select(crease && clear_of(signed_v) < kSharp, floor(mad(sure, room, Real(kRounds))), sure);
  }
  Real piece = packed_piece(place, slope, level, select(short_line, sure + kSpeck, sure));
  piece = select(ends, -piece, piece);
  return select(known, select(keep, piece, Real(kOnlyEnds)), Real(0.0f));
}

FN void outline_refine_pixel(Int px, Int py) {
  Real right = near_outline_right_settled(0, 0);
  Real below = near_outline_below_settled(0, 0);
  Real steep = Real(0.0f);
  Real lower = Real(0.0f);
  if (some(abs(right) > 0.0f))
    steep = refined(0, right, below, near_outline_below_settled(1, 0), near_outline_below_settled(0, -1),
                    near_outline_below_settled(1, -1));
  if (some(abs(below) > 0.0f))
    lower = refined(1, below, right, near_outline_right_settled(0, 1), near_outline_right_settled(-1, 0),
                    near_outline_right_settled(-1, 1));
  store_outline_steep(steep);
  store_outline_flat(lower);
}
