// Ends of lines that another line stands for, so that outline_trim drops what leads to them. Where a fold's surface
// ends, its rim and what goes on from it part at a low angle, and where one triangle of a mesh hides another their rims
// overlap for a few pixels: lines would have barbs, and run double.
//
// A tail goes, in a few rows, to an end that touches nothing and has nothing ahead, while another line of its object,
// the nearer surface not on the other side, runs beside it and on past that. A spur is but a few pieces, near another
// line, that lead nowhere.
//
// outline_tails: as outline_tail.kernel.h has it.
IN_REAL(depth)
IN_REAL(object_id)
IN_REAL(outline_steep_linked)
IN_REAL(outline_flat_linked)
OUT_REAL(outline_tails)
#include "effects/outline/outline_shallow.kernel.h"
#include "effects/outline/outline_tail.kernel.h"

CONST float kSame = 0.5f;      // pixels beside an end's way, up to which what is behind it is its own line
CONST float kFirst = -2.5f;    // pixels ahead of an end: from where
CONST float kLast = -0.7f;     // to where another line is looked for
CONST float kPast = 2.0f;      // that goes on to there,
CONST float kApproach = 0.7f;  // as far beside as before, at least: or else the end points to it
CONST int kPassing = 8;        // in so many rows
CONST float kAhead = 0.8f;     // pixels ahead of an end, from which on
CONST float kNear = 2.6f;      // and to which it goes on in what is there,
CONST float kAside = 1.1f;     // so many aside
CONST float kTouches = 1.1f;   // pixels from an end at which it touches a line,
CONST float kCorner = 1.6f;    // and at which a spur does
CONST float kFills = 1.5f;     // times alongside(), up to where the lines are between which it fills a gap
CONST float kCone = 0.35f;     // pixels beside its way per pixel, and kSame, that they may be

// An end of a line.
struct Tip {
  Int x, y;     // pixel of its piece,
  Real piece;   // that
  Vec2 at;      // where it crosses, from that pixel
  Vec2 way;     // unit vector, outward
  Vec2 nearer;  // to its nearer surface,
  Real object;  // and that one's object
};

// The object of a piece's nearer surface.
FN Real object_of(Int x, Int y, Real piece, Bool steep) {
  Bool other = side_of(piece) < -kHasSide;
  return load_object_id(x + select(steep && other, Int(1), Int(0)), y + select(!steep && other, Int(1), Int(0)));
}

// The end at a place along a line that began in a piece of one kind, from which it does not go on.
FN Tip tip_of(Bool asked, Along last, Bool steep, Real towards) {
  Vec2 at = middle_of(last.piece, last.steep, 0.0f);
  Vec2 way = way_of(asked, last.x, last.y, last.piece, last.steep, towards_at(last, steep, towards), at, 0.0f);
  way = chosen(dot(way, way) > 0.5f, way, lean_of(last.slope, steep, towards));
  return Tip(last.x, last.y, last.piece, at, way, nearer_of(last.piece, last.steep),
             object_of(last.x, last.y, last.piece, last.steep));
}

// Whether an end touches nothing and nothing is ahead of it.
FN_RARE Bool is_free(Bool asked, Tip end) {
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
          Bool touches = along > -kSame && dot(apart, apart) < kTouches * kTouches && !own;
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
    Vec2 apart = middle_of(passing.piece, passing.steep, 0.0f) - end.at +
                 Vec2(to_real(passing.x - end.x), to_real(passing.y - end.y));
    Bool past = passing.on && dot(end.way, apart) > kPast;
    passing.on = passing.on && !past;
    passed = passed || (past && cross(end.way, apart) * aside > aside * aside * kApproach);
  }
  return passed;
}

// Whether what is so far from an end of a few pieces is a line that they touch or go on to.
FN Bool leads_to(Vec2 way, Vec2 apart) {
  Real along = dot(way, apart);
  Bool touches = along > -kSame && dot(apart, apart) < kCorner * kCorner;
  return touches || (along > 0.0f && along < alongside() * kFills &&
                     abs(cross(way, apart)) < mad(along, Real(kCone), Real(kSame)));
}

// Whether what is no more than a few pieces, between two ends, is near another line and not between two, as what fills
// a gap is; of what is longer, whether neither end leads to any.
FN_RARE Bool is_spur(Bool asked, Bool longer, Tip up, Tip down) {
  Vec2 to = down.at - up.at + Vec2(to_real(down.x - up.x), to_real(down.y - up.y));
  Vec2 arm = to * Real(0.5f);
  Real extent = max(dot(arm, arm), Real(1e-6f));
  Vec2 middle = up.at + arm;
  Int x = to_int(floor(middle.x + 0.5f));
  Int y = to_int(floor(middle.y + 0.5f));
  Bool near = asked && !asked;
  Bool before = near;
  Bool after = near;
  int wide = int(alongside() * kFills) + spur_rows() / 2 + 3;
  for (int j = -wide; j <= wide; ++j)
    for (int i = -wide; i <= wide; ++i)
      for (int lying = 0; lying < 2; ++lying) {
        Bool look = asked && !(before && after);
        if (!some(look)) continue;
        Real piece = piece_at(lying, up.x + x + Int(i), up.y + y + Int(j));
        Bool here = look && seen(piece);
        if (!some(here)) continue;
        Vec2 apart = apart_from(middle, piece, lying, x + Int(i), y + Int(j), 0.0f);
        Vec2 off = apart - arm * clamp(dot(arm, apart) / extent, Real(-1.0f), Real(1.0f));
        here = here && dot(off, off) > kOther * kOther;
        near = near || (here && dot(off, off) < alongside() * alongside());
        before = before || (here && leads_to(up.way, apart + arm));
        after = after || (here && leads_to(down.way, apart - arm));
      }
  return near && !(before && after) && !(longer && (before || after));
}

// What is to be told of the ends of this pixel's piece of one kind.
FN Real told(Int px, Int py, Real piece, int lying) {
  Bool steep = steep_of(lying);
  Bool on = is_piece(piece);
  Along here = Along(on, place_of(piece), slope_of(piece), px, py, steep, piece, Real(0.0f));
  Real code = Real(0.0f);
  Bool spur = on && !on;
  for (int side = -1; side <= 1; side += 2) {
    Real towards = Real(float(side));
    Along next = next_along(here, px, py, steep, Int(side), towards);
    // At the picture's border no line ends.
    Int across = to_int(floor(mad(here.slope, towards, here.place) + 0.5f));
    Bool inside = in_picture(px + select(steep, across, Int(side)), py + select(steep, Int(side), across));
    Bool ends = on && !next.on && inside;
    if (!some(ends)) continue;
    Tip end = tip_of(ends, here, steep, towards);
    Bool passed = ends && is_shallow(px, py, steep);
    if (some(passed)) passed = is_free(passed, end);
    if (some(passed)) passed = is_passed(passed, end);
    code = select(passed, code + (side < 0 ? kPassedBefore : kPassedAfter), code);
    // The other end, if it is near.
    Along last = here;
    last.on = ends;
    Int rows = Int(0);
    for (int k = 1; k <= spur_rows() + 1; ++k) {
      if (!some(last.on)) continue;
      last = next_along(last, px, py, steep, Int(-k * side), -towards);
      rows = select(last.on, Int(k), rows);
    }
    Bool brief = ends && !last.on;
    Bool longer = rows > Int(short_spur_rows());
    brief = brief && (!longer || (is_crease(piece) && is_crease(last.piece)));
    if (some(brief)) brief = is_spur(brief, longer, end, tip_of(brief, last, steep, -towards));
    spur = spur || brief;
  }
  return select(spur, code + kSpur, code);
}

FN void outline_tails_pixel(Int px, Int py) {
  Real steep = near_outline_steep_linked(0, 0);
  Real lower = near_outline_flat_linked(0, 0);
  Real code = Real(0.0f);
  if (some(is_piece(steep))) code = told(px, py, steep, 0);
  if (some(is_piece(lower))) code = code + told(px, py, lower, 1) * kOfFlat;
  store_outline_tails(code);
}
