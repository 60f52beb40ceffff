// Ends of lines that another line goes on from a few pixels further, and aside, are joined to it. Where one triangle of
// a mesh hides another, and then the next one, each has a stroke of its own: what is one fold for the eye would be a
// row of them. Where an edge is just none for a few rows, a line would have a gap.
//
// Two ends are joined by a straight stroke if they face each other, no other line is near them or between, their nearer
// surfaces are on the same side, of one object and about as deep, and if each is the best for the other.
//
// outline_join: as outline_stroke.kernel.h has it.
IN_REAL(depth)
IN_REAL(object_id)
IN_REAL(outline_steep_linked)
IN_REAL(outline_flat_linked)
OUT_REAL(outline_join)
#include "effects/outline/outline_piece.kernel.h"
#include "effects/outline/outline_stroke.kernel.h"

CONST float kLeastSeen = 4.5f;    // sure_of from which on a piece counts
CONST int kFree = 3;              // pixels around an end in which no line is
CONST float kAhead = 0.8f;        // from so many pixels ahead
CONST float kNear = 2.2f;         // to so many,
CONST float kAside = 2.0f;        // and, not ahead, so many beside its way
CONST float kShallow = 16.0f;     // pixel sizes, per pixel of stride, that an end's jump may be
CONST int kBefore = 4;            // rows (columns) before an end that tell its way,
CONST float kAstray = 1.6f;       // pixels from one to the next: more is another line
CONST float kLeastOnward = 0.6f;  // of an end's way, along its rows (columns): others lean too much
CONST int kBeside = 2;            // per pixel of stride: see beside()
CONST float kFacing = 1.0f;       // least pixels ahead per pixel aside
CONST float kAlike = 0.5f;        // and between their ways, if one is turned round
CONST float kBends = 2.0f;        // pixels farther that an end may be that is ahead, per pixel of detour
CONST float kBlocks = 1.0f;       // pixels beside the way ahead, within which another line blocks it,
CONST float kBlocksMore = 0.2f;   // and more per pixel
CONST float kDeep = 3.0f;         // pixel sizes that a surface may be before or behind the line between two ends,
CONST float kDeeper = 1.0f;       // and more per pixel between them
CONST int kSamples = 5;           // of it
CONST float kHasSide = 0.05f;     // of nearer surfaces
CONST float kNever = 1e6f;        // the cost of what is not joined

// An end of a line.
struct End {
  Bool on;       // there is one
  Int x, y;      // its pixel
  Bool steep;    // kind of its piece
  Real towards;  // 1 if the line would go on in the next row (column), -1 in the one before
  Vec2 at;       // middle of its stroke
  Vec2 way;      // unit vector, outward
  Vec2 nearer;   // unit vector to its nearer surface, shorter if it lies partly on either side
};

FN Vec2 chosen(Bool first, Vec2 a, Vec2 b) { return Vec2(select(first, a.x, b.x), select(first, a.y, b.y)); }
FN Bool chosen(Bool first, Bool a, Bool b) { return (first && a) || (!first && b); }
FN End chosen(Bool first, End a, End b) {
  return End(chosen(first, a.on, b.on), select(first, a.x, b.x), select(first, a.y, b.y),
             chosen(first, a.steep, b.steep), select(first, a.towards, b.towards), chosen(first, a.at, b.at),
             chosen(first, a.way, b.way), chosen(first, a.nearer, b.nearer));
}

// Whether pieces are steep, of one kind for all pixels: steep (lying 0) or flat (1).
FN Bool steep_of(int lying) { return Real(float(lying)) < 0.5f; }

// The piece of a kind at a pixel; none outside the picture.
FN Real piece_at(Bool steep, Int x, Int y) {
  Real piece = select(steep, load_outline_steep_linked(x, y), load_outline_flat_linked(x, y));
  return select(in_picture(x, y), piece, Real(0.0f));
}

// The same of one kind for all pixels.
FN Real piece_at(int lying, Int x, Int y) {
  Real piece = lying == 0 ? load_outline_steep_linked(x, y) : load_outline_flat_linked(x, y);
  return select(in_picture(x, y), piece, Real(0.0f));
}

FN Bool seen(Real piece) { return is_piece(piece) && sure_of(piece) > kLeastSeen; }

FN Real cross(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }

// Whether a line has a piece in its next row (column), or goes on there in one of the other kind.
FN Bool goes_on(Bool asked, Int X, Int Y, Real piece, Bool steep, Real towards) {
  Real expected = mad(slope_of(piece), towards, place_of(piece));
  Int first = to_int(floor(expected));
  Int nearest = to_int(floor(expected + 0.5f));
  Int along = to_int(towards);
  Bool found = asked && !asked;
  for (int k = -1; k <= 1; ++k) {
    Int aside = first + Int(k);
    found = found || (asked && seen(piece_at(steep, X + select(steep, aside, along), Y + select(steep, along, aside))));
  }
  for (int k = -1; k <= 0; ++k) {
    Bool look = asked && !found;
    if (!some(look)) continue;
    Int on = along + Int(k);
    found = found || (look && seen(piece_at(!steep, X + select(steep, nearest, on), Y + select(steep, on, nearest))));
  }
  return found;
}

// Whether the two surfaces of a piece are not far from each other: a line that ends on a surface ends where its jump is
// little, and others end behind something.
FN Bool is_shallow(Int X, Int Y, Bool steep) {
  Real depth1 = load_depth(X, Y);
  Real depth2 = load_depth(X + select(steep, Int(1), Int(0)), Y + select(steep, Int(0), Int(1)));
  Real pixel = Real(F.ray_scale_x * kShallow * float(C.stride));
  if (F.orthographic == 0) pixel = pixel * min(depth1, depth2);
  return abs(depth1 - depth2) < pixel;
}

// The way of a line at its end `at`, outward: from the mean of its strokes' middles in the few rows (columns) before
// it, since the end's own piece knows that from too few. 0 where there are none.
FN Vec2 way_of(Bool asked, Int X, Int Y, Real piece, Bool steep, Real towards, Vec2 at) {
  Vec2 sum = Vec2(Real(0.0f), Real(0.0f));
  Real count = Real(0.0f);
  Real place = place_of(piece);
  for (int k = 1; k <= kBefore; ++k) {
    Int along = to_int(-towards * float(k));
    Real from = place;
    Real nearest = Real(kAstray);
    Vec2 middle = at;
    // Three pieces of its kind in this row (column), and two of the other kind in which it may cross that.
    for (int i = 0; i < 5; ++i) {
      Bool kind = i < 3 ? steep : !steep;
      Int across = to_int(floor(i < 3 ? from : from + 0.5f)) + Int(i < 3 ? i - 1 : 0);
      Int on = along - Int(i == 4 ? 1 : 0);
      Int x = select(steep, across, on);
      Int y = select(steep, on, across);
      Real other = piece_at(kind, X + x, Y + y);
      Bool here = asked && seen(other);
      if (!some(here)) continue;
      Real crossed = i < 3 ? to_real(across) + place_of(other) : to_real(across);
      here = here && abs(crossed - from) < nearest;
      Vec2 stroke = middle_of(other, kind, C.width_px) + Vec2(to_real(x), to_real(y));
      nearest = select(here, abs(crossed - from), nearest);
      place = select(here, crossed, place);
      middle = chosen(here, stroke, middle);
    }
    Bool found = nearest < kAstray;
    sum = chosen(found, sum + middle, sum);
    count = select(found, count + 1.0f, count);
  }
  Vec2 way = at - sum * (Real(1.0f) / max(count, Real(1.0f)));
  Real length = sqrt(max(dot(way, way), Real(1e-6f)));
  return way * (select(count > 0.0f, Real(1.0f), Real(0.0f)) / length);
}

// Whether any line is near an end, other than its own before it.
FN Bool is_near(Bool asked, Int X, Int Y, Vec2 way, Vec2 at) {
  Bool found = asked && !asked;
  for (int j = -kFree; j <= kFree; ++j)
    for (int i = -kFree; i <= kFree; ++i)
      for (int lying = 0; lying < 2; ++lying) {
        if (!some(asked && !found)) continue;
        Real piece = piece_at(lying, X + Int(i), Y + Int(j));
        Bool here = asked && !found && seen(piece);
        if (!some(here)) continue;
        Vec2 apart = middle_of(piece, steep_of(lying), C.width_px) + Vec2(Real(float(i)), Real(float(j))) - at;
        Real ahead = dot(way, apart);
        Bool on = ahead > kAhead && ahead < kNear;
        found = found || (here && (on || (ahead < kAhead && abs(cross(way, apart)) > kAside)));
      }
  return found;
}

// The end of a line at a piece, if it is asked for and there is one.
FN End end_of(Bool asked, Int X, Int Y, Real piece, Bool steep, Real towards) {
  Real slope = slope_of(piece);
  Real side = side_of(piece) / sqrt(mad(slope, slope, Real(1.0f)));
  Vec2 nearer = Vec2(select(steep, -side, slope * side), select(steep, slope * side, -side));
  Vec2 at = middle_of(piece, steep, C.width_px);
  Vec2 way = Vec2(Real(0.0f), Real(0.0f));
  Bool on = asked;
  if (some(on)) on = on && is_shallow(X, Y, steep);
  if (some(on)) on = on && !goes_on(on, X, Y, piece, steep, towards);
  if (some(on)) {
    way = way_of(on, X, Y, piece, steep, towards, at);
    on = on && dot(way, way) > 0.5f;
  }
  if (some(on)) on = on && !is_near(on, X, Y, way, at);
  return End(on, X, Y, steep, towards, at + Vec2(to_real(X), to_real(Y)), way, nearer);
}

// Pixels beside its way, within which another end need not be ahead.
FN int beside() { return kBeside * C.stride + 1; }

// Whether an end at so much from another one, with such a way, faces it: ahead, or, if it is near, just not behind.
FN Bool faces(Vec2 way, Vec2 apart) {
  Real along = dot(way, apart);
  Real aside = abs(cross(way, apart));
  return along > aside * kFacing || (along > 0.0f && aside < Real(float(beside())));
}

// What it costs to join two ends; kNever if they are none of one line.
FN Real cost_of(End a, End b) {
  Vec2 apart = b.at - a.at;
  Real distance = sqrt(dot(apart, apart));
  Bool fits = distance < Real(float(C.join) + 0.5f) && faces(a.way, apart) && faces(b.way, a.at - b.at) &&
              dot(a.way, b.way) < -kAlike && dot(a.nearer, b.nearer) > -kHasSide;
  Real detour = distance * 2.0f - dot(a.way, apart) + dot(b.way, apart);
  return select(a.on && b.on && fits, mad(detour, Real(kBends), distance), Real(kNever));
}

// Depth and object of the nearer surface at an end.
FN Vec2 surface_of(End a) {
  Int x = a.x;
  Int y = a.y;
  Bool other = select(a.steep, a.nearer.x, a.nearer.y) > kHasSide;
  x = x + select(a.steep && other, Int(1), Int(0));
  y = y + select(!a.steep && other, Int(1), Int(0));
  return Vec2(load_depth(x, y), load_object_id(x, y));
}

// Whether the surface is one from an end to another: of one object, and on the way not far from the line between them.
FN Bool one_surface(Bool asked, End a, End b) {
  Vec2 here = surface_of(a);
  Vec2 there = surface_of(b);
  Vec2 apart = b.at - a.at;
  Real pixel = Real(F.ray_scale_x);
  if (F.orthographic == 0) pixel = pixel * min(here.x, there.x);
  Real bound = pixel * mad(abs(apart.x) + abs(apart.y), Real(kDeeper), Real(kDeep));
  Bool one = asked && here.y == there.y && abs(here.x - there.x) < bound;
  for (int k = 1; k <= kSamples; ++k) {
    if (!some(one)) continue;
    Real share = Real(float(k) / float(kSamples + 1));
    Int x = to_int(floor(mad(apart.x, share, a.at.x + 0.5f)));
    Int y = to_int(floor(mad(apart.y, share, a.at.y + 0.5f)));
    Real between = mad(there.x - here.x, share, here.x);
    one = one && abs(load_depth(x, y) - between) < bound && load_object_id(x, y) == here.y;
  }
  return one;
}

// The end that is best to be joined to an end.
FN_RARE End best_for(End a) {
  End best = a;
  best.on = a.on && !a.on;
  Real least = Real(kNever);
  Bool on = a.on;
  Int along = to_int(a.towards);
  Real place = place_of(piece_at(a.steep, a.x, a.y));
  Real lean = select(a.steep, a.way.x, a.way.y) / max(abs(select(a.steep, a.way.y, a.way.x)), Real(kLeastOnward));
  for (int j = -beside(); j <= C.join; ++j) {
    int wide = beside() + 1 + (j > 0 ? j / 2 : 0);
    Bool open = on && least > Real(float(j));
    if (!some(open)) continue;
    Int across = to_int(floor(mad(lean, Real(float(j)), place)));
    Bool blocked = on && !on;
    for (int k = -wide; k <= wide; ++k) {
      Int aside = across + Int(k);
      Int ahead = along * Int(j);
      Int x = a.x + select(a.steep, aside, ahead);
      Int y = a.y + select(a.steep, ahead, aside);
      for (int kind = 0; kind < 2; ++kind) {
        Bool steep = kind == 0 ? a.steep : !a.steep;
        Real other = piece_at(steep, x, y);
        Bool here = open && seen(other) && aside <= Int(C.join) && aside >= Int(-C.join);
        if (!some(here)) continue;
        Vec2 apart = middle_of(other, steep, C.width_px) + Vec2(to_real(x), to_real(y)) - a.at;
        Real straight = dot(a.way, apart);
        Bool fits = here && faces(a.way, apart);
        Real towards = select(select(steep, a.way.y, a.way.x) > 0.0f, Real(-1.0f), Real(1.0f));
        End b = end_of(fits, x, y, other, steep, towards);
        Real cost = cost_of(a, b);
        fits = fits && cost < kNever;
        if (some(fits)) fits = fits && one_surface(fits, a, b);
        Real off = abs(cross(a.way, apart));
        Bool blocks = here && !fits && straight > 1.0f && off < mad(straight, Real(kBlocksMore), Real(kBlocks));
        blocked = blocked || blocks;
        Bool better = fits && cost < least;
        least = select(better, cost, least);
        best = chosen(better, b, best);
      }
    }
    on = on && !blocked;
  }
  return best;
}

// `coded`, or what outline_join tells of the end of a piece, if it is joined: one in a pixel, the last.
FN Real joined(Int px, Int py, int lying, Real piece, int side, Real coded) {
  Bool look = seen(piece);
  if (!some(look)) return coded;
  Bool steep = steep_of(lying);
  Real towards = Real(float(side));
  End a = end_of(look, px, py, piece, steep, towards);
  if (!some(a.on)) return coded;
  End b = best_for(a);
  if (!some(b.on)) return coded;
  End back = best_for(b);
  Bool both = b.on && back.on && back.x == px && back.y == py && ((back.steep && steep) || (!back.steep && !steep)) &&
              back.towards == towards;
  Real other = piece_at(b.steep, b.x, b.y);
  return select(both, packed_join(b.at - a.at, linked_of(other), steep), coded);
}

FN void outline_join_pixel(Int px, Int py) {
  Real steep = near_outline_steep_linked(0, 0);
  Real lower = near_outline_flat_linked(0, 0);
  Bool any = is_piece(steep) || is_piece(lower);
  Real coded = Real(0.0f);
  if (some(any)) {
    coded = select(any, Real(kOnlyEnds), coded);
    for (int towards = -1; towards <= 1; towards += 2) {
      coded = joined(px, py, 0, steep, towards, coded);
      coded = joined(px, py, 1, lower, towards, coded);
    }
    coded = select(steep < 0.0f || lower < 0.0f, -coded, coded);
  }
  store_outline_join(coded);
}
