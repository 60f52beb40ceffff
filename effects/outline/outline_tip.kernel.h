// Ends of lines as outline_tails and outline_strays know them, and what short strokes with two of them are. The text
// before has what outline_tail.kernel.h asks for, and object_id.
#include "effects/outline/outline_tail.kernel.h"

CONST float kSame = 0.5f;     // pixels beside an end's way, up to which what is behind it is its own line
CONST float kCorner = 1.6f;   // pixels from an end at which a spur touches a line
CONST float kClose = 0.6f;    // times alongside(): closer to a stroke that may have gaps it is not alone
CONST float kFills = 1.5f;    // times alongside(), up to where the lines are between which it fills a gap
CONST float kCone = 0.35f;    // pixels beside its way per pixel, and kSame, that they may be
CONST float kOnFaith = 2.5f;  // pixels more than a spur is long, up to where a line is that does not end there
CONST float kAcross = 0.7f;   // sine between a spur and a line, from which on that runs across it
CONST float kAlike = 0.5f;    // sine between two ways, up to which they are of one line

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

// Whether a piece so far from an end of a few pieces is of a line that they touch or go on to: one that ends there and
// comes the same way, or one no farther off than `most` that does not run alongside.
FN Bool leads_to(Vec2 way, Vec2 apart, Real piece, int lying, Real most) {
  Real along = dot(way, apart);
  Real off = abs(cross(way, apart));
  Bool alike = abs(cross(way, lean_of(slope_of(piece), steep_of(lying), Real(1.0f)))) < kAlike;
  Bool touches = along > -kSame && dot(apart, apart) < kCorner * kCorner;
  Bool near = along < select(piece < 0.0f && alike, Real(alongside() * kFills), most) &&
              (piece < 0.0f || !alike || off < kOther);
  return touches || (along > 0.0f && near && off < mad(along, Real(kCone), Real(kSame)));
}

// What is known of lines at a place: 1 if one passes by that runs across `way`, -1 if one ends there, or else 0. known:
// so far. apart: of another piece, from that place.
FN Real passes_by(Bool here, Real known, Vec2 way, Vec2 apart, Real piece, int lying) {
  Bool near = here && dot(apart, apart) < kCorner * kCorner &&
              abs(cross(way, lean_of(slope_of(piece), steep_of(lying), Real(1.0f)))) > kAcross;
  return select(near && !(known < 0.0f), select(piece < 0.0f, Real(-1.0f), Real(1.0f)), known);
}

// The straight way between two ends.
struct Chord {
  Vec2 middle;  // from the first end's pixel,
  Int x, y;     // and the pixel there, counted from that
  Vec2 arm;     // from there to the second end,
  Real extent;  // and its length, squared
};

FN Chord chord_of(Tip first, Tip second) {
  Vec2 apart = Vec2(to_real(second.x - first.x), to_real(second.y - first.y));
  Vec2 arm = (second.at - first.at + apart) * Real(0.5f);
  Vec2 middle = first.at + arm;
  return Chord(middle, to_int(floor(middle.x + 0.5f)), to_int(floor(middle.y + 0.5f)), arm,
               max(dot(arm, arm), Real(1e-6f)));
}

// How far what is so far from its middle is from a chord.
FN Vec2 off_chord(Chord chord, Vec2 apart) {
  return apart - chord.arm * clamp(dot(chord.arm, apart) / chord.extent, Real(-1.0f), Real(1.0f));
}

// Whether what is no more than a few pieces, between two ends, is near another line and not between two, as what fills
// a gap is; of what is longer, whether neither end leads to any, or one only to the side of a line that passes by; of
// what is longer yet, whether one does.
FN_RARE Bool is_spur(Bool asked, Bool longer, Bool longest, Tip up, Tip down) {
  Chord chord = chord_of(up, down);
  Real most = sqrt(chord.extent) * 2.0f + kOnFaith;
  Bool near = asked && !asked;
  Bool before = near;
  Bool after = near;
  Vec2 along = chord.arm * (Real(1.0f) / sqrt(chord.extent));
  Real by_before = Real(0.0f);
  Real by_after = Real(0.0f);
  int wide = int(alongside() * kFills) + spur_rows() / 2 + 3;
  for (int j = -wide; j <= wide; ++j)
    for (int i = -wide; i <= wide; ++i)
      for (int lying = 0; lying < 2; ++lying) {
        Bool look = asked && !(before && after);
        if (!some(look)) continue;
        Real piece = piece_at(lying, up.x + chord.x + Int(i), up.y + chord.y + Int(j));
        Bool here = look && seen(piece);
        if (!some(here)) continue;
        Vec2 apart = apart_from(chord.middle, piece, lying, chord.x + Int(i), chord.y + Int(j), 0.0f);
        Vec2 off = off_chord(chord, apart);
        by_before = passes_by(here, by_before, along, apart + chord.arm, piece, lying);
        by_after = passes_by(here, by_after, along, apart - chord.arm, piece, lying);
        here = here && dot(off, off) > kOther * kOther;
        near = near || (here && dot(off, off) < alongside() * alongside());
        before = before || (here && leads_to(up.way, apart + chord.arm, piece, lying, most));
        after = after || (here && leads_to(down.way, apart - chord.arm, piece, lying, most));
      }
  Bool leads = (before && !(by_before > 0.0f)) || (after && !(by_after > 0.0f));
  Bool stands = by_before > 0.0f || by_after > 0.0f;
  return near && !(before && after) && !(longer && leads) && (stands || !(longest && longer));
}

// Whether a piece is within one object.
FN Bool within_one(Tip end, Bool steep) {
  return load_object_id(end.x, end.y) ==
         load_object_id(end.x + select(steep, Int(1), Int(0)), end.y + select(steep, Int(0), Int(1)));
}

// Whether any other line is beside a piece, no farther off than about so many pixels.
FN_RARE Bool has_other(Bool asked, Along here, float most) {
  Vec2 at = middle_of(here.piece, here.steep, 0.0f);
  Vec2 way = lean_of(slope_of(here.piece), here.steep, Real(1.0f));
  Bool found = asked && !asked;
  int wide = int(most);
  for (int j = -wide; j <= wide; ++j)
    for (int i = -wide; i <= wide; ++i)
      for (int lying = 0; lying < 2; ++lying) {
        Bool look = asked && !found;
        if (!some(look)) continue;
        Real piece = piece_at(lying, here.x + Int(i), here.y + Int(j));
        Bool other = look && is_piece(piece);
        if (!some(other)) continue;
        Vec2 apart = apart_from(at, piece, lying, Int(i), Int(j), 0.0f);
        found = found || (other && abs(cross(way, apart)) > kOther && abs(dot(way, apart)) < kOther);
      }
  return found;
}

// What leads from an end to another one that is near.
struct Stroke {
  Bool on;     // it does, and this is not the picture's border
  Tip other;   // end,
  Bool steep;  // kind of its piece,
  Int rows;    // rows (columns) from the first end to it
};

// The stroke from the end of a line, away from its side, if it has no more than `most` rows and one. over: with gaps of
// a row.
FN Stroke stroke_from(Along from, Int px, Int py, Int side, Real towards, int most, bool over) {
  Followed line = followed(from, px, py, from.steep, Int(0) - side, -towards, most, over);
  Along last = line.last;
  Bool brief = line.ends && goes_inside(last, px, py, from.steep, side * (Int(-1) - line.rows), -towards);
  return Stroke(brief, tip_of(brief, last, from.steep, -towards), last.steep, line.rows);
}

// How many rows each of a stroke's ends tells of that is to be dropped: all that it can.
FN Real rows_lost(Stroke stroke) { return min(to_real(stroke.rows) + 1.0f, Real(kMostLost)); }

// Whether a stroke from an end is alone on its surface; one of a crease may have other lines beside it, and what is
// followed over gaps such as are not close.
FN_RARE Bool is_alone(Bool asked, Tip end, Stroke stroke, Along from, Int px, Int py, Int side, Real towards, int most,
                      bool over) {
  Tip other = stroke.other;
  Bool alone = asked && within_one(end, from.steep) && within_one(other, stroke.steep) && end.object == other.object;
  Walk way = Walk(from, from.on && !from.on);
  way.at.on = alone;
  for (int k = 1; k <= most + 1; ++k) {
    if (!some(way.at.on)) continue;
    alone =
        alone && !(has_other(way.at.on, way.at, over ? kClose * alongside() : alongside()) && !is_crease(way.at.piece));
    way = walked(way, px, py, from.steep, k, Int(0) - side, -towards, over);
    way.at.on = way.at.on && alone;
  }
  return alone;
}
