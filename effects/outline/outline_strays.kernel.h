// Ends of what is left of lines and is to be dropped, too: dashes that outline_join found nothing for. Where a barb was
// cut off its stem, or a line in two, the rest is such a dash, and where a fold is one for but a few pixels.
//
// A stray is a stroke alone on its surface, up to a forty-third of the picture's height long, a spur a few pieces near
// another line, neither joined nor touching anything at either end, or nothing but crumbs that lead nowhere. An islet
// is crumbs that lie together: see outline_islet.kernel.h. Of others the ends are told that go on, free, a few rows
// past where a line is joined to theirs.
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
// That of this pixel is told of then.
FN Bool told_near(int i, int j) { return Int(i) == Int(0) && Int(j) == Int(0); }
#include "effects/outline/outline_islet.kernel.h"

CONST float kCornerHigh = 0.5f;  // pixels more, per pixel of stride but one, at which an end touches a line that passes
CONST float kNearFirst = 5.0f;   // pixels from an end, within which a stroke leads back to it
CONST float kPastStray = 0.5f;   // times C.bevel, past the ends of a stroke, and
CONST float kBesideStray = 0.35f;  // beside it, up to where crumbs are its own,
CONST float kMoat = 3.0f;  // and pixels around those without another line: two rows of one at 45 degrees are 2.9 apart
CONST float kMet = 2.0f;   // pixels, and half the width, from a stroke's chord, where what joins another line meets it
CONST float kMetBeside = 2.0f;  // pixels beside the way of a line, where what is joined to it ends

FN float past_stray() { return kPastStray * float(C.bevel); }

// Whether an end is joined to another line, or touches one. A line can end twice at one place, in a piece of each kind:
// what joins one of them joins both.
FN_RARE Bool leads_on(Bool asked, Tip end) {
  Bool found = asked && !asked;
  float corner = kCorner + kCornerHigh * float(C.stride - 1);
  int wide = int(corner) + 2;
  for (int j = -wide; j <= wide; ++j)
    for (int i = -wide; i <= wide; ++i)
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
        Real along = dot(end.way, apart);
        Bool own = along < kSame && abs(cross(end.way, apart)) < select(along < 0.0f, Real(kOther), Real(kSame));
        Real most = select(piece < 0.0f, Real(kCorner), Real(corner));
        Bool touches = here && !own && dot(apart, apart) < most * most;
        found = found || joined || touches;
      }
  return found;
}

// What is a stroke's own: it itself, and crumbs beside it and at its ends.
struct Island {
  Vec2 along;  // unit vector along its chord,
  Real reach;  // and how far from the middle of that either end is
};

// Whether a place, counted from the chord's middle, is so far out at least: 0 is the shore.
FN Bool is_off(Island island, Vec2 apart, float beyond) {
  return abs(dot(island.along, apart)) - island.reach > past_stray() + beyond ||
         abs(cross(island.along, apart)) > kBesideStray * float(C.bevel) + beyond;
}

FN Island island_of(Chord chord) {
  Real reach = sqrt(chord.extent);
  return Island(chord.arm * (Real(1.0f) / reach), reach);
}

// Whether what joins an end of another line leads to a stroke from an end, or, if that has crumbs, from what is its own
// to what is not, or back.
FN_RARE Bool is_met(Bool asked, Bool crumbs, Tip end, Stroke stroke) {
  Chord chord = chord_of(end, stroke.other);
  Int x = end.x + chord.x;
  Int y = end.y + chord.y;
  Vec2 middle = chord.middle - Vec2(to_real(chord.x), to_real(chord.y));
  Island island = island_of(chord);
  Bool met = asked && !asked;
  float near = kMet + 0.5f * C.width_px;
  // Half of a stroke leans up to 1.5 aside in each of its rows.
  int wide = (C.join > C.onward ? C.join : C.onward) + 3 * long_stray_rows() / 4 + int(C.width_px) + 2;
  for (int j = -wide; j <= wide; ++j)
    for (int i = -wide; i <= wide; ++i) {
      Bool look = asked && !met && in_picture(x + Int(i), y + Int(j));
      if (!some(look)) continue;
      Real join = load_outline_join(x + Int(i), y + Int(j));
      Bool here = look && has_join(bits_of(join));
      if (!some(here)) continue;
      Bool kind = joined_steep(join);
      Real piece = piece_at(kind, x + Int(i), y + Int(j));
      Vec2 pixel = Vec2(Real(float(i)), Real(float(j))) - middle;
      Vec2 starts = middle_of(piece, kind, 0.0f) + pixel;
      Vec2 from = off_chord(chord, starts);
      // Strokes are drawn up to half the width beside where they cross.
      Vec2 ends = middle_of(piece, kind, C.width_px) + joined_apart(join) + pixel;
      Vec2 to = off_chord(chord, ends);
      Bool meets = dot(to, to) < near * near && dot(from, from) > kOther * kOther;
      Bool leads = !same(is_off(island, starts, 0.0f), is_off(island, ends, 0.0f));
      met = met || (here && chosen(crumbs, leads, meets));
    }
  return met;
}

// Whether there is room for crumbs at an end, within the picture.
FN Bool has_room(Tip end) {
  int room = int(past_stray() + kMoat);
  return in_picture(end.x - Int(room), end.y - Int(room)) && in_picture(end.x + Int(room), end.y + Int(room));
}

// Whether a stroke is alone but for crumbs: around them there is nothing.
FN_RARE Bool is_island(Bool asked, Tip end, Stroke stroke) {
  Chord chord = chord_of(end, stroke.other);
  Island island = island_of(chord);
  Bool alone = asked && has_room(end) && has_room(stroke.other);
  int wide = int(past_stray() + kMoat) + 3 * long_stray_rows() / 4 + 2;
  for (int j = -wide; j <= wide; ++j)
    for (int i = -wide; i <= wide; ++i)
      for (int lying = 0; lying < 2; ++lying) {
        if (!some(alone)) continue;
        Real piece = piece_at(lying, end.x + chord.x + Int(i), end.y + chord.y + Int(j));
        Bool here = alone && is_piece(piece);
        if (!some(here)) continue;
        Vec2 apart = apart_from(chord.middle, piece, lying, chord.x + Int(i), chord.y + Int(j), 0.0f);
        alone = alone && !(here && is_off(island, apart, 0.0f) && !is_off(island, apart, kMoat));
      }
  return alone;
}

// Whether a stroke's other end is one for a line of its piece's kind, too, and that leads back to the first, or as near
// to it as is asked: or else but a part of it would be dropped.
FN_RARE Bool leads_back(Bool asked, Tip end, Along here, Stroke stroke, Real towards, Real near) {
  Tip other = stroke.other;
  Along from = Along(asked, place_of(other.piece), slope_of(other.piece), other.x, other.y, stroke.steep, other.piece,
                     Real(0.0f));
  Real outward = towards_at(from, here.steep, -towards);
  Int side = to_int(outward);
  Walk beyond = next_over(Walk(from, asked && !asked), other.x, other.y, stroke.steep, 1, side, outward);
  from.on = asked && !beyond.at.on;
  Stroke back = stroke_from(from, other.x, other.y, side, outward, long_stray_rows(), true);
  Vec2 apart = back.other.at - end.at + Vec2(to_real(back.other.x - end.x), to_real(back.other.y - end.y));
  return back.on && dot(apart, apart) < near * near;
}

// How many rows a line goes on past the last place where others are joined to its side, one of them across, if those
// are fewer than a burr has: what comes the same way goes on instead.
FN_RARE Real rows_past(Bool asked, Tip end, Bool steep) {
  Vec2 at = middle_of(end.piece, steep, C.width_px);
  float most = float(burr_rows());
  Real nearest = Real(most);
  Bool across = asked && !asked;
  int wide = (C.join > C.onward ? C.join : C.onward) + burr_rows() + 1;
  for (int j = -wide; j <= wide; ++j)
    for (int i = -wide; i <= wide; ++i) {
      Bool look = asked && in_picture(end.x + Int(i), end.y + Int(j));
      if (!some(look)) continue;
      Real join = load_outline_join(end.x + Int(i), end.y + Int(j));
      Bool here = look && has_join(bits_of(join));
      if (!some(here)) continue;
      Bool kind = joined_steep(join);
      Real piece = piece_at(kind, end.x + Int(i), end.y + Int(j));
      Vec2 to = middle_of(piece, kind, C.width_px) + joined_apart(join) + Vec2(Real(float(i)), Real(float(j))) - at;
      Real back = -dot(end.way, to);
      here = here && abs(cross(end.way, to)) < kMetBeside && back > -kMetBeside && back < most;
      Bool alike = abs(cross(end.way, lean_of(slope_of(piece), kind, Real(1.0f)))) < kAlike;
      across = across || (here && !alike);
      nearest = select(here, min(nearest, back), nearest);
    }
  Real rows = nearest * abs(select(steep, end.way.y, end.way.x));
  return select(across && nearest > kSame, floor(rows), Real(0.0f));
}

// What is to be told of the ends of this pixel's piece of one kind.
FN Real told(Int px, Int py, Real piece, int lying) {
  Bool steep = steep_of(lying);
  Along from = Along(is_piece(piece), place_of(piece), slope_of(piece), px, py, steep, piece, Real(0.0f));
  Real code = Real(0.0f);
  for (int side = -1; side <= 1; side += 2) {
    Real towards = Real(float(side));
    Walk next = next_over(Walk(from, from.on && !from.on), px, py, steep, 1, Int(side), towards);
    Along here = from;
    here.on = from.on && !next.at.on && goes_inside(from, px, py, steep, Int(side), towards);
    if (!some(here.on)) continue;
    Tip end = tip_of(here.on, here, steep, towards);
    Bool leads = leads_on(here.on, end);
    Stroke stroke = stroke_from(here, px, py, Int(side), towards, long_stray_rows(), true);
    Bool brief = stroke.on;
    Bool stray = stroke.rows > Int(kLeastStray);
    Bool island = brief && stray && within_one(end, steep) && within_one(stroke.other, stroke.steep);
    island = island && end.object == stroke.other.object;
    if (some(island)) island = is_island(island, end, stroke);
    Bool bare = brief && !island && !leads;
    if (some(bare)) bare = bare && !leads_on(bare, stroke.other);
    brief = bare || island;
    Real near = max(select(island, Real(past_stray()), Real(0.0f)), Real(kNearFirst));
    if (some(brief)) brief = brief && leads_back(brief, end, here, stroke, towards, near);
    Bool alone = brief && stray;
    bare = alone && !island;
    if (some(bare)) bare = is_alone(bare, end, stroke, here, px, py, Int(side), towards, long_stray_rows(), true);
    alone = bare || (alone && island);
    if (some(alone)) alone = alone && !is_met(alone, island, end, stroke);
    Bool spur = brief && !(stroke.rows > Int(spur_rows()));
    spur = spur && within_one(end, steep) && within_one(stroke.other, stroke.steep);
    if (some(spur)) spur = is_spur(spur, spur, stray, end, stroke.other);
    Real lost = select(alone || spur, rows_lost(stroke), Real(0.0f));
    // What is but one piece has no way that could be joined, and is in the way of others.
    Bool single = stroke.on && !leads && stroke.rows == Int(0);
    if (some(single)) single = single && within_one(end, steep) && !is_met(single, single && !single, end, stroke);
    lost = select(single, Real(1.0f), lost);
    Bool islet = stroke.on && !(lost > 0.0f);
    if (some(islet)) lost = select(is_islet(islet), rows_lost(stroke), lost);
    Bool past = here.on && !leads && !(lost > 0.0f);
    if (some(past)) lost = lost + rows_past(past, end, steep);
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
