// Ends of lines that another line stands for, so that outline_trim drops what leads to them. Where a fold's surface
// ends, its rim and what goes on from it part at a low angle, and where one triangle of a mesh hides another their rims
// overlap for a few pixels: lines would have barbs, and run double.
//
// A tail goes, in a few rows, to an end that touches nothing and has nothing ahead, while another line of its object,
// the nearer surface not on the other side, runs beside it and on past that. A spur is but a few pieces, near another
// line, that lead nowhere, or stand on its side. A burr is what goes on past a crossing for a few rows. A hook is where
// a crease, or a rim that ends free, leaves its way in its last rows, or near what hides a part of its bevel. A stray
// is a stroke alone on its surface; one of a crease may run beside other lines.
//
// outline_tails: as outline_tail.kernel.h has it.
IN_REAL(depth)
IN_REAL(object_id)
IN_REAL(outline_steep_even)
IN_REAL(outline_flat_even)
OUT_REAL(outline_tails)
#include "effects/outline/outline_shallow.kernel.h"
FN Real steep_at(Int x, Int y) { return load_outline_steep_even(x, y); }
FN Real flat_at(Int x, Int y) { return load_outline_flat_even(x, y); }
#include "effects/outline/outline_tip.kernel.h"

CONST float kFirst = -2.5f;         // pixels ahead of an end: from where
CONST float kLast = -0.7f;          // to where another line is looked for
CONST float kPast = 2.0f;           // that goes on to there,
CONST float kApproach = 0.7f;       // as far beside as before, at least: or else the end points to it
CONST int kPassing = 8;             // in so many rows
CONST float kAhead = 0.8f;          // pixels ahead of an end, from which on
CONST float kNear = 2.6f;           // and to which it goes on in what is there,
CONST float kAside = 1.1f;          // so many aside
CONST float kTouches = 1.1f;        // pixels from an end at which it touches a line,
CONST float kTouchesHigh = 0.25f;   // and more per pixel of stride but one,
CONST float kMoreThanSpeck = 3.0f;  // pieces of a line that an end points to, at least
CONST float kCrosses = 0.6f;        // pixels from a line, within which it is crossed,
CONST float kCrossesAlong = 0.8f;   // and along it
CONST float kLeansOff = 0.4f;       // between two slopes, from which on pieces of one kind are of two lines
CONST float kBack = 0.6f;           // cosine from which on a way is back along a line,
CONST int kTrunk = 3;               // rows that this goes on for beyond a crossing,
CONST int kLonger = 2;              // and that the other one goes on for more than a burr
CONST float kStraight = 0.6f;       // pixels beside the way of a line, up to which it comes straight,
CONST float kHookOff = 1.0f;        // and from which on its last rows are a hook,
CONST float kCutOff = 0.4f;         // or those of a bevel that is hidden in part

#include "effects/outline/outline_cut.kernel.h"

// Whether an end touches nothing within so many pixels and nothing is ahead of it.
FN_RARE Bool is_free(Bool asked, Tip end, float touching) {
  Bool free = asked;
  // Around the end, and around a place ahead of it.
  for (int part = 0; part < 2; ++part) {
    Real ahead = Real(part == 0 ? 0.0f : 0.5f * (kAhead + kNear));
    Int x = to_int(floor(mad(end.way.x, ahead, end.at.x)));
    Int y = to_int(floor(mad(end.way.y, ahead, end.at.y)));
    for (int j = -2; j <= 2; ++j)
      for (int i = -2; i <= 2; ++i)
        for (int lying = 0; lying < 2; ++lying) {
          if (!some(free)) continue;
          Real piece = piece_at(lying, end.x + x + Int(i), end.y + y + Int(j));
          Bool here = free && seen(piece);
          if (!some(here)) continue;
          Vec2 apart = apart_from(end.at, piece, lying, x + Int(i), y + Int(j), 0.0f);
          Real along = dot(end.way, apart);
          Real off = abs(cross(end.way, apart));
          Bool own = off < kSame && along < kSame;
          Bool touches = along > -kSame && dot(apart, apart) < touching * touching && !own;
          free = free && !(here && (touches || (along > kAhead && along < kNear && off < kAside)));
        }
  }
  return free;
}

// Whether a line beside an end goes on past it.
FN_RARE Bool is_passed(Bool asked, Tip end) {
  Real nearest = Real(alongside());
  Real aside = Real(0.0f);  // how far it is beside, above 0 to one side
  Real first = Real(0.0f);  // its piece
  Int x = end.x;
  Int y = end.y;
  Bool steep = asked;
  int wide = int(alongside()) + 3;
  for (int j = -wide; j <= wide; ++j)
    for (int i = -wide; i <= wide; ++i)
      for (int lying = 0; lying < 2; ++lying) {
        Real piece = piece_at(lying, end.x + Int(i), end.y + Int(j));
        Bool here = asked && seen(piece);
        if (!some(here)) continue;
        Vec2 apart = apart_from(end.at, piece, lying, Int(i), Int(j), 0.0f);
        Real along = dot(end.way, apart);
        Real side = cross(end.way, apart);
        Bool beside = here && along > kFirst && along < kLast && abs(side) > kOther && abs(side) < nearest;
        beside = beside && stands_for(piece, end.piece);
        beside = beside && dot(nearer_of(piece, steep_of(lying)), end.nearer) > -kHasSide;
        if (some(beside))
          beside = beside && object_of(end.x + Int(i), end.y + Int(j), piece, steep_of(lying)) == end.object;
        nearest = select(beside, abs(side), nearest);
        aside = select(beside, side, aside);
        first = select(beside, piece, first);
        x = select(beside, end.x + Int(i), x);
        y = select(beside, end.y + Int(j), y);
        steep = chosen(beside, steep_of(lying), steep);
      }
  Bool on = asked && is_piece(first);
  Real towards = select(select(steep, end.way.y, end.way.x) < 0.0f, Real(-1.0f), Real(1.0f));
  Along passing = Along(on, place_of(first), slope_of(first), x, y, steep, first, Real(kLeastSeen));
  Bool passed = on && !on;
  for (int k = 1; k <= kPassing; ++k) {
    if (!some(passing.on)) continue;
    passing = next_along(passing, x, y, steep, to_int(towards * float(k)), towards);
    Vec2 apart = middle_at(passing, end.x, end.y, 0.0f) - end.at;
    Bool past = passing.on && dot(end.way, apart) > kPast;
    passing.on = passing.on && !past;
    passed = passed || (past && cross(end.way, apart) * aside > aside * aside * kApproach);
  }
  return passed;
}

// Whether at a place on the way from an end, so many rows and `back` away, lines part: another one goes on from there
// for longer than to there, neither back that way nor as the first does, which goes on by `beyond`, or 0 if it does
// not. If it does not, the other goes on to both sides: or else the two are one that turns.
FN_RARE Bool is_crossed(Bool asked, Along last, Vec2 back, Vec2 beyond, int rows) {
  Vec2 at = middle_of(last.piece, last.steep, 0.0f);
  Bool found = asked && !asked;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i)
      for (int lying = 0; lying < 2; ++lying) {
        Bool steep = steep_of(lying);
        Bool look = asked && !found;
        if (i == 0 && j == 0) look = look && !same(last.steep, steep);
        if (!some(look)) continue;
        Int x = last.x + Int(i);
        Int y = last.y + Int(j);
        Real piece = piece_at(lying, x, y);
        Bool here = look && seen(piece);
        if (!some(here)) continue;
        Vec2 apart = apart_from(at, piece, lying, Int(i), Int(j), 0.0f);
        Vec2 lean = lean_of(slope_of(piece), steep, Real(1.0f));
        here = here && abs(cross(lean, apart)) < kCrosses && abs(dot(lean, apart)) < kCrossesAlong;
        // A line of its own kind is another one only if it leans otherwise.
        here = here && (!same(last.steep, steep) || abs(slope_of(piece) - last.slope) > kLeansOff);
        if (!some(here)) continue;
        Bool parts = here && !here;
        Bool both = here;
        for (int side = -1; side <= 1; side += 2) {
          Real towards = Real(float(side));
          Along other = Along(here, place_of(piece), slope_of(piece), x, y, steep, piece, Real(kLeastSeen));
          for (int k = 1; k <= rows + kLonger; ++k) {
            if (some(other.on)) other = next_along(other, x, y, steep, Int(k * side), towards);
            other.on = other.on && same(other.steep, steep);
            if (k <= kTrunk) both = both && other.on;
          }
          parts = parts || (other.on && dot(lean, back) * towards < sqrt(dot(back, back)) * kBack &&
                            dot(lean, beyond) * towards <= sqrt(dot(beyond, beyond)) * kBack);
        }
        found = found || (parts && (both || dot(beyond, beyond) > 0.0f));
      }
  return found;
}

// A piece near an end, as that sees it.
struct Seen {
  Bool touches;  // and it is not what leads there
  Bool ahead;    // no farther off than ends are joined
};

FN Seen seen_from(Tip end, Real piece, int lying, int i, int j) {
  Vec2 apart = apart_from(end.at, piece, lying, Int(i), Int(j), 0.0f);
  Real along = dot(end.way, apart);
  Real off = abs(cross(end.way, apart));
  Bool own = off < kSame && along < kSame;
  return Seen(along > -kSame && dot(apart, apart) < kCorner * kCorner && !own,
              along > kSame && along < Real(float(C.join)) && off < mad(along, Real(kCone), Real(kSame)));
}

// Whether an end points to another line, of which more than a speck is ahead.
FN_RARE Bool points_on(Bool asked, Tip end) {
  Real count = Real(0.0f);
  for (int j = -C.join; j <= C.join; ++j)
    for (int i = -C.join; i <= C.join; ++i)
      for (int lying = 0; lying < 2; ++lying) {
        Bool look = asked && count < kMoreThanSpeck;
        if (!some(look)) continue;
        Real piece = piece_at(lying, end.x + Int(i), end.y + Int(j));
        Bool here = look && seen(piece);
        if (!some(here)) continue;
        Seen line = seen_from(end, piece, lying, i, j);
        count = select(here && (line.touches || line.ahead), count + 1.0f, count);
      }
  return count >= kMoreThanSpeck;
}

// Whether an end faces that of another line, which comes the same way.
FN_RARE Bool faces_end(Bool asked, Tip end) {
  Bool found = asked && !asked;
  for (int j = -C.join; j <= C.join; ++j)
    for (int i = -C.join; i <= C.join; ++i)
      for (int lying = 0; lying < 2; ++lying) {
        Bool look = asked && !found;
        if (!some(look)) continue;
        Real piece = piece_at(lying, end.x + Int(i), end.y + Int(j));
        Bool here = look && seen(piece) && piece < 0.0f;
        if (!some(here)) continue;
        Vec2 lean = lean_of(slope_of(piece), steep_of(lying), Real(1.0f));
        found = found || (here && seen_from(end, piece, lying, i, j).ahead && abs(cross(end.way, lean)) < kAlike &&
                          dot(nearer_of(piece, steep_of(lying)), end.nearer) > -kHasSide);
      }
  return found;
}

// How many rows of a line, from its end on, are a short stroke that is to be dropped: all, if it is a spur or a stray.
// Each end tells of the half of it that outline_trim follows to there.
FN_RARE Real stroke_of(Tip end, Along from, Int px, Int py, Int side, Real towards) {
  Stroke stroke = stroke_from(from, px, py, side, towards, stray_rows(), false);
  if (!some(stroke.on)) return Real(0.0f);
  Bool longer = stroke.rows > Int(short_spur_rows());
  Bool stray = stroke.rows > Int(kLeastStray);
  Bool alone = stroke.on && stray;
  if (some(alone)) alone = is_alone(alone, end, stroke, from, px, py, side, towards, stray_rows(), false);
  if (some(alone)) alone = alone && !points_on(alone, end);
  if (some(alone)) alone = alone && !points_on(alone, stroke.other);
  Bool spur = stroke.on && !(stroke.rows > Int(spur_rows()));
  spur = spur && (!longer || (within_one(end, from.steep) && within_one(stroke.other, stroke.steep)));
  if (some(spur)) spur = is_spur(spur, longer, stray, end, stroke.other);
  return select(alone || spur, rows_lost(stroke), Real(0.0f));
}

// How many rows of a line, from its end on, are a burr: a line that they cross is so near.
FN_RARE Real burr_of(Bool asked, Tip end, Along here, Int px, Int py, Int side, Real towards) {
  Bool steep = here.steep;
  Along last = here;
  last.on = asked;
  Real rows = Real(0.0f);
  for (int k = 1; k <= burr_rows(); ++k) {
    if (!some(last.on)) continue;
    last = next_along(last, px, py, steep, side * Int(-k), -towards);
    Bool crossed = last.on;
    if (some(crossed)) {
      Vec2 at = middle_at(last, px, py, 0.0f);
      Along trunk = last;
      for (int m = 1; m <= kTrunk; ++m)
        if (some(trunk.on)) trunk = next_along(trunk, px, py, steep, side * Int(-k - m), -towards);
      Vec2 beyond = middle_at(trunk, px, py, 0.0f) - at;
      crossed = is_crossed(crossed, last, at - end.at, chosen(trunk.on, beyond, at - at), k);
    }
    rows = select(crossed, Real(float(k)), rows);
    last.on = last.on && !crossed;
  }
  return rows;
}

// How many rows of a crease, or of a line that begins as a rim, from its end on, are a hook: they leave the way that it
// came straight. cut: where a bevel is hidden in part, its middle seems to lie in what is left of it.
FN_RARE Real hook_of(Bool asked, Bool cut, Along here, Int px, Int py, Int side, Real towards) {
  Bool steep = here.steep;
  int all = kComing * C.stride;
  Bool is_rim = !is_crease(here.piece);
  Real most = select(cut, Real(float(C.bevel)), Real(float(all / 4)));
  Real middle = select(cut, Real(float((C.bevel + all) / 2)), Real(float(all / 2)));
  Real off_way = select(cut, Real(kCutOff), Real(kHookOff));
  Vec2 zero = Vec2(Real(0.0f), Real(0.0f));
  Vec2 far = zero;
  Vec2 near = zero;
  Along last = here;
  last.on = asked;
  for (int k = 1; k <= all; ++k) {
    if (!some(last.on)) continue;
    last = next_along(last, px, py, steep, side * Int(-k), -towards);
    last.on = last.on && (is_rim || is_crease(last.piece));
    Vec2 at = middle_at(last, px, py, 0.0f);
    Real row = Real(float(k));
    far = chosen(row > middle, far + at, far);
    near = chosen(row > most && row <= middle, near + at, near);
  }
  Bool straight = last.on;
  if (!some(straight)) return Real(0.0f);
  far = far * (Real(1.0f) / (Real(float(all)) - middle));
  near = near * (Real(1.0f) / (middle - most));
  Vec2 way = near - far;
  way = way * (Real(1.0f) / sqrt(max(dot(way, way), Real(1e-6f))));
  Real rows = Real(0.0f);
  last = here;
  last.on = straight;
  for (int k = 0; k <= all; ++k) {
    if (!some(last.on)) continue;
    if (k > 0) last = next_along(last, px, py, steep, side * Int(-k), -towards);
    Vec2 at = middle_at(last, px, py, 0.0f);
    Real off = abs(cross(way, at - near));
    Bool may = Real(float(k)) <= most;
    rows = select(may && off > off_way, Real(float(k + 1)), rows);
    straight = straight && (may || off < kStraight);
    last.on = last.on && straight;
  }
  return select(straight, rows, Real(0.0f));
}

// What is to be told of the ends of this pixel's piece of one kind.
FN Real told(Int px, Int py, Real piece, int lying) {
  Bool steep = steep_of(lying);
  Bool on = is_piece(piece);
  Along here = Along(on, place_of(piece), slope_of(piece), px, py, steep, piece, Real(0.0f));
  Real code = Real(0.0f);
  for (int side = -1; side <= 1; side += 2) {
    Real towards = Real(float(side));
    Along next = next_along(here, px, py, steep, Int(side), towards);
    Bool ends = on && !next.on && goes_inside(here, px, py, steep, Int(side), towards);
    if (!some(ends)) continue;
    Tip end = tip_of(ends, here, steep, towards);
    Bool passed = ends && is_shallow(px, py, steep);
    if (some(passed)) passed = is_free(passed, end, kTouches);
    Bool free = passed;
    if (C.stride > 1 && some(passed))
      passed = passed && is_free(passed, end, kTouches + kTouchesHigh * float(C.stride - 1));
    if (some(passed)) passed = is_passed(passed, end);
    free = free && !passed;
    Real lost = Real(0.0f);
    if (some(free)) lost = burr_of(free, end, here, px, py, Int(side), towards);
    Bool burr = lost > 0.0f;
    if (some(burr)) lost = select(faces_end(burr, end), Real(0.0f), lost);
    code = select(passed, code + (side < 0 ? kPassedBefore : kPassedAfter), code);
    Bool hook = ends && (free || is_crease(piece)) && !(lost > 0.0f);
    // Where a bevel takes all rows that would tell the way, hooks are as elsewhere.
    Bool cut = hook && is_crease(piece) && Int(C.bevel + 2) <= Int(kComing * C.stride);
    if (some(cut)) cut = is_cut(cut, px, py, steep);
    if (some(hook)) lost = select(hook, hook_of(hook, cut, here, px, py, Int(side), towards), lost);
    Along from = here;
    from.on = ends;
    Real stroke = stroke_of(end, from, px, py, Int(side), towards);
    lost = select(stroke > 0.0f, stroke, lost);
    code = mad(lost, Real(side < 0 ? kLostBefore : kLostAfter), code);
  }
  return code;
}

FN void outline_tails_pixel(Int px, Int py) {
  Real steep = near_outline_steep_even(0, 0);
  Real lower = near_outline_flat_even(0, 0);
  Real code = Real(0.0f);
  if (some(is_piece(steep))) code = told(px, py, steep, 0);
  if (some(is_piece(lower))) code = code + told(px, py, lower, 1) * kOfFlat;
  store_outline_tails(code);
}
