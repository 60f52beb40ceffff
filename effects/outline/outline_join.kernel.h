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
CONST int kFree = 2;              // pixels ahead of an end and beside it in which there is no other line
CONST float kFacing = 0.7f;       // least cosine between the way of an end and where the other one is
CONST float kAlike = 0.5f;        // and between the ways of both
CONST float kBends = 2.0f;        // pixels farther that an end may be that is ahead, per pixel of detour
CONST float kBlocks = 1.0f;       // pixels beside the way ahead, within which another line blocks it,
CONST float kBlocksMore = 0.2f;   // and more per pixel
CONST float kOneSurface = 10.0f;  // pixel sizes per pixel that a surface may be deeper at the other end
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

// The piece of a kind at a pixel; none outside the picture.
FN Real piece_at(Bool steep, Int X, Int Y) {
  Bool inside = X >= Int(0) && X < Int(F.width) && Y >= Int(0) && Y < Int(F.height);
  Real piece = select(steep, load_outline_steep_linked(X, Y), load_outline_flat_linked(X, Y));
  return select(inside, piece, Real(0.0f));
}
FN Bool seen(Real piece) { return is_piece(piece) && linked_of(piece) * kSure > kLeastSeen; }

// Whether a line goes on in its next row (column), or there is another one near its end.
FN Bool goes_on(Bool asked, Int X, Int Y, Real piece, Bool steep, Real towards) {
  Real expected = mad(slope_of(piece), towards, place_of(piece));
  Int across = to_int(floor(expected));
  Int along = to_int(towards);
  Bool found = asked && !asked;
  for (int k = -1; k <= 1; ++k) {
    Int aside = across + Int(k);
    Real next = piece_at(steep, X + select(steep, aside, along), Y + select(steep, along, aside));
    found = found || (asked && seen(next));
  }
  for (int j = 0; j <= kFree; ++j)
    for (int k = -kFree; k <= kFree; ++k) {
      Bool look = asked && !found;
      if (!some(look)) continue;
      Int aside = across + Int(k);
      Int on = along * Int(j);
      Int x = X + select(steep, aside, on);
      Int y = Y + select(steep, on, aside);
      Bool other = seen(piece_at(!steep, x, y));
      if (j > 0) other = other || seen(piece_at(steep, x, y));
      found = found || (look && other);
    }
  return found;
}

// Whether a line ends here, and is there on the other side.
FN Bool ends_at(Bool asked, Int X, Int Y, Real piece, Bool steep, Real towards) {
  Bool ends = asked;
  if (some(ends)) ends = ends && !goes_on(ends, X, Y, piece, steep, towards);
  if (some(ends)) ends = ends && goes_on(ends, X, Y, piece, steep, -towards);
  return ends;
}

FN End end_of(Bool on, Int X, Int Y, Real piece, Bool steep, Real towards) {
  Real slope = slope_of(piece);
  Real shrink = Real(1.0f) / sqrt(mad(slope, slope, Real(1.0f)));
  Vec2 way = Vec2(select(steep, slope, Real(1.0f)), select(steep, Real(1.0f), slope)) * (shrink * towards);
  Real side = side_of(piece) * shrink;
  Vec2 nearer = Vec2(select(steep, -side, slope * side), select(steep, slope * side, -side));
  Vec2 at = middle_of(piece, steep, C.width_px);
  at = Vec2(at.x + to_real(X), at.y + to_real(Y));
  return End(on, X, Y, steep, towards, at, way, nearer);
}

// What it costs to join two ends; kNever if they are none of one line.
FN Real cost_of(End a, End b) {
  Vec2 apart = b.at - a.at;
  Real squared = dot(apart, apart);
  Real distance = sqrt(squared);
  Real along_a = dot(a.way, apart);
  Real along_b = -dot(b.way, apart);
  Bool fits = min(along_a, along_b) > distance * kFacing && dot(a.way, b.way) < -kAlike &&
              distance < Real(float(C.join) + 0.5f) && dot(a.nearer, b.nearer) > -kHasSide;
  Real cost = mad(distance * 2.0f - along_a - along_b, Real(kBends), distance);
  return select(a.on && b.on && fits, cost, Real(kNever));
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

// The end that is best to be joined to an end.
FN_RARE End best_for(End a) {
  End best = a;
  best.on = a.on && !a.on;
  Real least = Real(kNever);
  Bool on = a.on;
  Vec2 surface = surface_of(a);
  Real pixel = Real(F.ray_scale_x * kOneSurface);
  if (F.orthographic == 0) pixel = pixel * surface.x;
  Int along = to_int(a.towards);
  Real piece = piece_at(a.steep, a.x, a.y);
  for (int j = 0; j <= C.join; ++j) {
    int wide = 2 + (j * 4) / 5;
    Bool open = on && least > Real(float(j));
    if (!some(open)) continue;
    Int across = to_int(floor(mad(slope_of(piece), a.towards * float(j), place_of(piece))));
    Bool blocked = on && !on;
    for (int k = -wide; k <= wide; ++k) {
      Int aside = across + Int(k);
      Int ahead = along * Int(j);
      Int x = a.x + select(a.steep, aside, ahead);
      Int y = a.y + select(a.steep, ahead, aside);
      for (int kind = 0; kind < 2; ++kind) {
        Bool steep = kind == 0 ? a.steep : !a.steep;
        Real other = piece_at(steep, x, y);
        Bool here = open && seen(other);
        if (j == 0 && kind == 0) here = here && !here;
        if (!some(here)) continue;
        End b = end_of(here, x, y, other, steep, Real(1.0f));
        Vec2 apart = b.at - a.at;
        Bool away = dot(b.way, apart) > 0.0f;
        b.towards = select(away, Real(-1.0f), b.towards);
        b.way = Vec2(select(away, -b.way.x, b.way.x), select(away, -b.way.y, b.way.y));
        Real cost = cost_of(a, b);
        Bool fits = here && cost < kNever;
        if (some(fits)) fits = fits && ends_at(fits, x, y, other, steep, b.towards);
        if (some(fits)) {
          Vec2 there = surface_of(b);
          fits =
              fits && there.y == surface.y && abs(there.x - surface.x) < pixel * (abs(apart.x) + abs(apart.y) + 1.0f);
        }
        Real off = abs(a.way.x * apart.y - a.way.y * apart.x);
        Real straight = dot(a.way, apart);
        blocked =
            blocked || (here && !fits && straight > 1.0f && off < mad(straight, Real(kBlocksMore), Real(kBlocks)));
        Bool better = fits && cost < least;
        least = select(better, cost, least);
        best.on = best.on || better;
        best.x = select(better, b.x, best.x);
        best.y = select(better, b.y, best.y);
        best.steep = (better && b.steep) || (!better && best.steep);
        best.towards = select(better, b.towards, best.towards);
      }
    }
    on = on && !blocked;
  }
  Real found = piece_at(best.steep, best.x, best.y);
  return end_of(best.on, best.x, best.y, found, best.steep, best.towards);
}

// `coded`, or what outline_join tells of the end of a piece, if it is joined.
FN Real joined(Int px, Int py, Real piece, Bool steep, Real towards, Real coded) {
  Bool look = ends_at(seen(piece), px, py, piece, steep, towards);
  if (!some(look)) return coded;
  End a = end_of(look, px, py, piece, steep, towards);
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
    Bool yes = any || !any;
    coded = select(any, Real(kOnlyEnds), coded);
    for (int towards = -1; towards <= 1; towards += 2) {
      if (some(is_piece(steep))) coded = joined(px, py, steep, yes, Real(float(towards)), coded);
      if (some(is_piece(lower))) coded = joined(px, py, lower, !yes, Real(float(towards)), coded);
    }
    coded = select(steep < 0.0f || lower < 0.0f, -coded, coded);
  }
  store_outline_join(coded);
}
