// Ends of lines that another line goes on from a few pixels further, and aside, are joined to it. Where one triangle of
// a mesh hides another, and then the next one, each has a stroke of its own: what is one fold for the eye would be a
// row of them. Where an edge is just none for a few rows, a line would have a gap.
//
// Two ends are joined by a straight stroke if they face each other, no other line is near them or between, their nearer
// surfaces are on the same side, of one object and about as deep, and if each is the best for the other. An end that is
// joined to none, and also one that has other lines near it, goes on to a line a few pixels ahead that it points to. A
// crease goes on farther, up to C.onward pixels, but no farther than it came straight.
//
// The text before has depth, normal, object_id, and steep_at(x, y) and flat_at(x, y), as outline_end.kernel.h asks.
#include "effects/outline/outline_end.kernel.h"
#include "effects/outline/outline_shallow.kernel.h"

CONST int kFree = 3;              // pixels around an end in which no line is
CONST float kAhead = 0.8f;        // from so many pixels ahead
CONST float kNear = 2.2f;         // to so many,
CONST float kAside = 2.0f;        // and, not ahead, so many beside its way
CONST float kLeastOnward = 0.6f;  // of an end's way, along its rows (columns): others lean too much
CONST int kBeside = 2;            // per pixel of stride: see beside()
CONST float kWholly = 0.8f;       // of its side, from which on a line lies on that alone
CONST float kFacing = 1.0f;       // least pixels ahead per pixel aside
CONST float kAlike = 0.5f;        // and between their ways, if one is turned round
CONST float kBends = 2.0f;        // pixels farther that an end may be that is ahead, per pixel of detour
CONST float kBlocks = 1.0f;       // pixels beside the way ahead, within which another line blocks it,
CONST float kBlocksMore = 0.2f;   // and more per pixel
CONST float kDeep = 3.0f;         // pixel sizes that a surface may be before or behind both ends,
CONST float kDeeper = 1.0f;       // and more per pixel between them
CONST int kSamples = 5;           // of it
CONST int kShort = 3;             // pixels, per pixel of stride,
CONST int kShortMore = 2;         // and more, of a line that it points to,
CONST float kShortMost = 1.0f;    // and more if nothing is near, or it is a crease, or meets that at no low angle
CONST float kPoints = 0.3f;       // pixels beside its way, per pixel, and half of one, that this may be,
CONST float kPointsFar = 0.15f;   // and where it is farther off;
CONST float kAsideCosts = 3.0f;   // what those count beside those ahead, of a crease that is cut, and far off
CONST float kOnFaith = 2.5f;      // pixels more than a crease came straight, that it goes on to what is near
CONST float kMeets = 0.5f;        // sine of the angle at which that way meets a line of its own object at least
CONST float kStillTurns = 0.3f;   // of the crease's squared chord, what it turns along the way,
CONST float kEven = 0.02f;        // and what a side of it turns that is flat
CONST float kFirm = 0.7f;         // share of sure, of both,
CONST float kFirmCut = 0.55f;     // or of the end of a crease that is cut
CONST float kNearly = 0.8f;       // share of the way to it on which its surface is asked
CONST float kTilted = 6.0f;       // pixel sizes per pixel that its surface may be tilted,
CONST float kFalls = 12.0f;       // and fall away behind the end of a crease, where another side of it begins
CONST float kNever = 1e6f;        // the cost of what is not joined

#include "effects/outline/outline_cut.kernel.h"

// An end of a line.
struct End {
  Bool on;       // there is one
  Bool open;     // and no line is near it
  Int x, y;      // its pixel
  Bool steep;    // kind of its piece
  Real towards;  // 1 if the line would go on in the next row (column), -1 in the one before
  Vec2 at;       // middle of its stroke
  Vec2 way;      // unit vector, outward
  Vec2 nearer;   // unit vector to its nearer surface, shorter if it lies partly on either side
};

FN End chosen(Bool first, End a, End b) {
  return End(chosen(first, a.on, b.on), chosen(first, a.open, b.open), select(first, a.x, b.x), select(first, a.y, b.y),
             chosen(first, a.steep, b.steep), select(first, a.towards, b.towards), chosen(first, a.at, b.at),
             chosen(first, a.way, b.way), chosen(first, a.nearer, b.nearer));
}

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
        Vec2 apart = apart_from(at, piece, lying, Int(i), Int(j), C.width_px);
        Real ahead = dot(way, apart);
        Bool on = ahead > kAhead && ahead < kNear;
        found = found || (here && (on || (ahead < kAhead && abs(cross(way, apart)) > kAside)));
      }
  return found;
}

// The end of a line at a piece, if it is asked for and there is one.
FN End end_of(Bool asked, Int X, Int Y, Real piece, Bool steep, Real towards) {
  Vec2 nearer = nearer_of(piece, steep);
  Vec2 at = middle_of(piece, steep, C.width_px);
  Vec2 way = Vec2(Real(0.0f), Real(0.0f));
  Bool on = asked;
  if (some(on)) on = on && is_shallow(X, Y, steep);
  if (some(on)) on = on && !goes_on(on, X, Y, piece, steep, towards);
  if (some(on)) {
    way = way_of(on, X, Y, piece, steep, towards, at, C.width_px);
    on = on && dot(way, way) > 0.5f;
  }
  Bool open = on;
  if (some(on)) open = on && !is_near(on, X, Y, way, at);
  return End(on, open, X, Y, steep, towards, at + Vec2(to_real(X), to_real(Y)), way, nearer);
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
  return select(a.open && b.open && fits, mad(detour, Real(kBends), distance), Real(kNever));
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

// The depth under the middle of an end's stroke, where that lies wholly on its nearer surface, which is so deep beside
// the crossing: on what is tilted much the two differ.
FN Real depth_under(End a, Vec2 surface) {
  Int x = to_int(floor(a.at.x + 0.5f));
  Int y = to_int(floor(a.at.y + 0.5f));
  Real depth = load_depth(x, y);
  Bool own = in_picture(x, y) && is_surface(depth) && load_object_id(x, y) == surface.y &&
             dot(a.nearer, a.nearer) > kWholly * kWholly;
  return select(own, depth, surface.x);
}

// Whether the surface is one from an end to another: of one object, not much deeper at one of them, and on the way, as
// the stroke is drawn, not before or behind both.
FN Bool one_surface(Bool asked, End a, End b) {
  Vec2 here = surface_of(a);
  Vec2 there = surface_of(b);
  Vec2 apart = b.at - a.at;
  Real pixel = Real(F.ray_scale_x);
  if (F.orthographic == 0) pixel = pixel * min(here.x, there.x);
  Bool one = asked && here.y == there.y && abs(here.x - there.x) < pixel * (kShallow * float(C.stride));
  if (!some(one)) return one;
  Real under_a = depth_under(a, here);
  Real under_b = depth_under(b, there);
  Real bound = pixel * mad(abs(apart.x) + abs(apart.y), Real(kDeeper), Real(kDeep));
  Real nearest = min(min(here.x, there.x), min(under_a, under_b)) - bound;
  Real farthest = max(max(here.x, there.x), max(under_a, under_b)) + bound;
  for (int k = 1; k <= kSamples; ++k) {
    if (!some(one)) continue;
    Real share = Real(float(k) / float(kSamples + 1));
    Int x = to_int(floor(mad(apart.x, share, a.at.x + 0.5f)));
    Int y = to_int(floor(mad(apart.y, share, a.at.y + 0.5f)));
    Real depth = load_depth(x, y);
    one = one && depth > nearest && depth < farthest && load_object_id(x, y) == here.y;
  }
  return one;
}

// The end that is best to be joined to an end.
FN_RARE End best_for(End a) {
  End best = a;
  best.on = a.on && !a.on;
  best.open = best.on;
  Real least = Real(kNever);
  Bool on = a.open;
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

// What an end points to that is a few pixels short of another line.
struct Target {
  Bool on;
  Bool far;    // farther off than where lines are looked for around most ends
  Real ahead;  // pixels along the end's way
  Real cost;   // these, and pixels aside
  Real sine;   // of the angle between the two
  Vec2 apart;  // from the end's middle to that of the line's stroke
  Real sure;   // of that
};

// Whether pixel (x2, y2) is of the same surface as (x, y), which is so many pixels away.
FN Bool of_one_surface(Int x, Int y, Int x2, Int y2, float pixels) {
  Real depth = load_depth(x, y);
  Real pixel = Real(F.ray_scale_x * kFalls * pixels);
  if (F.orthographic == 0) pixel = pixel * depth;
  return in_picture(x2, y2) && load_object_id(x2, y2) == load_object_id(x, y) &&
         abs(load_depth(x2, y2) - depth) < pixel;
}

// What lies to one side of a crease, half as far from it as a wide bevel reaches.
struct Beside {
  Bool known;
  Vec3 turn;  // from the crease's normal to that there
};

FN Beside beside_of(Int x, Int y, Vec2 to) {
  Int x2 = x + to_int(floor(to.x + 0.5f));
  Int y2 = y + to_int(floor(to.y + 0.5f));
  Vec3 here = load_normal(x, y);
  Bool known = of_one_surface(x, y, x2, y2, float(C.bevel));
  return Beside(known, select(known, load_normal(x2, y2) - here, here - here));
}

FN Vec2 across_crease(Vec2 way) { return Vec2(-way.y, way.x) * Real(0.5f * float(C.bevel + 1)); }

// Whether a crease that goes such a way is at a place: the surfaces to its two sides, or one of them and it, face
// apart.
FN Bool turns_at(Int x, Int y, Vec2 way) {
  Vec2 off = across_crease(way);
  Beside a = beside_of(x, y, off);
  Beside b = beside_of(x, y, off * Real(-1.0f));
  Vec3 across = a.turn - b.turn;
  Real turn = max(dot(a.turn, a.turn), dot(b.turn, b.turn));
  turn = select(a.known && b.known, max(turn, dot(across, across)), turn);
  return turn > Real(C.crease_chord * kStillTurns);
}

// Whether the surface to one side of a crease is flat beyond what a bevel may take.
FN Bool is_flat_side(Int x, Int y, Vec2 off) {
  Int x1 = x + to_int(floor(mad(off.x, Real(2.0f), Real(0.5f))));
  Int y1 = y + to_int(floor(mad(off.y, Real(2.0f), Real(0.5f))));
  Int x2 = x1 + x1 - x;
  Int y2 = y1 + y1 - y;
  Vec3 bend = load_normal(x2, y2) - load_normal(x1, y1);
  return of_one_surface(x, y, x1, y1, float(C.bevel + 1)) && of_one_surface(x1, y1, x2, y2, float(C.bevel + 1)) &&
         dot(bend, bend) < Real(C.crease_chord * kEven);
}

// Whether one of the sides of a crease is flat: what is round has no edge.
FN Bool has_flat_side(Int x, Int y, Vec2 way) {
  Vec2 off = across_crease(way);
  return is_flat_side(x, y, off) || is_flat_side(x, y, off * Real(-1.0f));
}

// How a crease comes to its end: the last rows (columns) before may bend where another edge is near.
struct Coming {
  Real rows;  // for so many of them, up to C.onward,
  Int x, y;   // by this pixel,
  Vec2 at;    // to there, counted from the end's pixel, if it went straight on,
  Vec2 way;   // this way: a unit vector; 0 if it is shorter
};

FN_RARE Coming coming_to(Bool asked, End a) {
  Vec2 end = a.at - Vec2(to_real(a.x), to_real(a.y));
  Vec2 zero = end - end;
  Vec2 far = zero;
  Vec2 near = zero;
  Real fars = Real(0.0f);
  Real nears = Real(0.0f);
  int all = kComing * C.stride;
  Coming found = Coming(Real(0.0f), a.x, a.y, end, zero);
  Real piece = piece_at(a.steep, a.x, a.y);
  Along before = Along(asked, place_of(piece), slope_of(piece), a.x, a.y, a.steep, piece, Real(kLeastSeen));
  Bool gap = asked && !asked;
  for (int k = 1; k <= C.onward; ++k) {
    if (!some(before.on)) continue;
    Along next = next_along(before, a.x, a.y, a.steep, to_int(-a.towards * float(k)), -a.towards);
    Bool here = next.on && is_crease(next.piece);
    // One row may be missing.
    Bool miss = before.on && !next.on && !gap;
    next.place = select(miss, mad(before.slope, -a.towards, before.place), next.place);
    gap = gap || miss;
    next.on = here || miss;
    before = next;
    found.rows = select(here, Real(float(k)), found.rows);
    if (k > all) continue;
    Vec2 middle = middle_at(before, a.x, a.y, C.width_px);
    Real one = select(here, Real(1.0f), Real(0.0f));
    if (k == all / 2) {
      found.x = select(before.on, before.x, found.x);
      found.y = select(before.on, before.y, found.y);
    }
    if (k > all / 2) {
      far = far + middle * one;
      fars = fars + one;
    } else if (k > all / 4) {
      near = near + middle * one;
      nears = nears + one;
    }
  }
  near = near * (Real(1.0f) / max(nears, Real(1.0f)));
  Vec2 way = near - far * (Real(1.0f) / max(fars, Real(1.0f)));
  way = way * (Real(1.0f) / sqrt(max(dot(way, way), Real(1e-6f))));
  Bool known = found.rows >= Real(float(all));
  found.way = chosen(known, way, zero);
  found.at = chosen(known, near + way * dot(way, end - near), end);
  return found;
}

// The better of a target and a piece, if that is asked for, that is so much from the end, of which the way is known.
FN Target better_of(Bool asked, Target target, Real piece, int lying, Vec2 way, Vec2 apart, Real along, Real aside) {
  Bool here = asked && along + aside < target.cost;
  Vec2 lean = lean_of(slope_of(piece), steep_of(lying), Real(1.0f));
  return Target(target.on || here, target.far, select(here, along, target.ahead),
                select(here, along + aside, target.cost), select(here, abs(cross(way, lean)), target.sine),
                chosen(here, apart, target.apart), select(here, linked_of(piece), target.sure));
}

// The line that an end points to, if its surface goes on to there. A crease may end well before: near where a rounded
// edge meets another one, or a rim hides one of its sides, it is none that is clear. It goes on so far at most as it
// was one before.
FN_RARE Target target_of(Bool asked, End a) {
  Vec2 at = a.at - Vec2(to_real(a.x), to_real(a.y));
  Real none = Real(0.0f);
  Target target = Target(asked && !asked, asked && !asked, none, Real(kNever), none, at, none);
  Bool crease = asked && dot(a.nearer, a.nearer) < kHasSide * kHasSide;
  int short_px = kShort * C.stride + kShortMore;
  Real short_way = Real(float(short_px) + kShortMost);
  Bool sure_way = crease || a.open;
  Coming coming = Coming(Real(0.0f), a.x, a.y, at, at - at);
  if (some(crease)) coming = coming_to(crease, a);
  Bool straight = crease && dot(coming.way, coming.way) > 0.5f;
  Bool cut = straight;
  if (some(cut)) cut = is_cut(cut, a.x, a.y, a.steep);
  Vec2 way = chosen(cut, coming.way, a.way);
  // A crease of one row, between lines, is the end of one of them.
  Bool leads = asked && (a.open || !crease || coming.rows >= 1.0f);
  leads = leads && (cut || linked_of(piece_at(a.steep, a.x, a.y)) > kFirm);
  for (int j = -short_px - 2; j <= short_px + 2; ++j)
    for (int i = -short_px - 2; i <= short_px + 2; ++i)
      for (int lying = 0; lying < 2; ++lying) {
        if (!some(leads)) continue;
        Real piece = piece_at(lying, a.x + Int(i), a.y + Int(j));
        Bool here = leads && is_piece(piece) && linked_of(piece) > kFirm;
        if (!some(here)) continue;
        Vec2 apart = apart_from(at, piece, lying, Int(i), Int(j), C.width_px);
        Vec2 onward = chosen(cut, apart + at - coming.at, apart);
        Real along = dot(way, onward);
        Real aside = abs(cross(way, onward));
        here = here && along > kAhead && along < short_way && aside < mad(along, Real(kPoints), Real(0.5f));
        aside = aside * select(cut, Real(kAsideCosts), Real(1.0f));
        Vec2 lean = lean_of(slope_of(piece), steep_of(lying), Real(1.0f));
        here = here && (sure_way || along < short_way - kShortMost || abs(cross(a.way, lean)) > kMeets);
        here = here && (!crease || along < coming.rows + kOnFaith);
        target = better_of(here, target, piece, lying, way, apart, along, aside);
      }
  // Farther off, row by row (column by column) along its way.
  Bool far = straight && !target.on && leads;
  if (some(far)) {
    Bool steep = abs(coming.way.y) > abs(coming.way.x);
    Real most = max(abs(coming.way.x), abs(coming.way.y));
    Vec2 step = coming.way * (Real(1.0f) / max(most, Real(0.5f)));
    int beside = int(0.5f * C.width_px) + 2;
    for (int k = 1; k <= C.onward; ++k) {
      Int x = to_int(floor(mad(step.x, Real(float(k)), coming.at.x + 0.5f)));
      Int y = to_int(floor(mad(step.y, Real(float(k)), coming.at.y + 0.5f)));
      int wide = beside + int(kPointsFar * 1.5f * float(k));
      for (int m = -wide; m <= wide; ++m)
        for (int lying = 0; lying < 2; ++lying) {
          Int i = x + select(steep, Int(m), Int(0));
          Int j = y + select(steep, Int(0), Int(m));
          Real piece = piece_at(lying, a.x + i, a.y + j);
          Bool here = far && is_piece(piece) && linked_of(piece) > kFirm;
          if (!some(here)) continue;
          Vec2 apart = apart_from(at, piece, lying, i, j, C.width_px);
          Vec2 onward = apart + at - coming.at;
          Real along = dot(coming.way, onward);
          Real aside = abs(cross(coming.way, onward));
          here = here && along > kAhead && along <= coming.rows && aside < mad(along, Real(kPointsFar), Real(0.5f)) &&
                 max(abs(apart.x), abs(apart.y)) < Real(float(C.onward));
          target = better_of(here, target, piece, lying, coming.way, apart, along, aside * kAsideCosts);
        }
    }
  }
  if (!some(target.on)) return target;
  Vec2 surface = surface_of(a);
  Real pixel = Real(F.ray_scale_x);
  if (F.orthographic == 0) pixel = pixel * surface.x;
  far = far && target.on;
  target.far = far;
  if (some(far)) {
    Int x = to_int(floor(target.apart.x + a.at.x + 0.5f));
    Int y = to_int(floor(target.apart.y + a.at.y + 0.5f));
    Bool own = target.sine < kMeets && load_object_id(x, y) == surface.y;
    target.on = target.on && (!far || (has_flat_side(coming.x, coming.y, coming.way) && !own));
  }
  for (int k = 1; k <= kSamples; ++k) {
    if (!some(target.on)) continue;
    Real share = Real(kNearly * float(k) / float(kSamples));
    Int x = to_int(floor(mad(target.apart.x, share, a.at.x + 0.5f)));
    Int y = to_int(floor(mad(target.apart.y, share, a.at.y + 0.5f)));
    Real depth = load_depth(x, y);
    Bool own = load_object_id(x, y) == surface.y;
    Real way = target.ahead * share;
    Bool here = own && surface.x - depth < pixel * mad(way, Real(kTilted), Real(kDeep)) &&
                depth - surface.x < pixel * mad(way, select(crease, Real(kFalls), Real(kTilted)), Real(kDeep));
    if (some(far)) here = here && (!far || turns_at(x, y, coming.way));
    // Of a rim that it meets at a low angle the stroke begins before.
    if (k > kSamples / 2) here = here || ((far || cut) && !own && depth < surface.x);
    target.on = target.on && here;
  }
  return target;
}

// What is known of a pixel's ends.
struct Ends {
  Real coded;  // what outline_join tells of one that is joined to another: the last
  End alone;   // one that is sure and joined to none: the last that is open, if one is
};

// The same with the end of a piece to one side.
FN Ends joined(Int px, Int py, int lying, Real piece, int side, Ends ends) {
  Bool look = seen(piece);
  if (!some(look)) return ends;
  Bool steep = steep_of(lying);
  Real towards = Real(float(side));
  End a = end_of(look, px, py, piece, steep, towards);
  if (!some(a.on)) return ends;
  Bool both = a.on && !a.on;
  End b = a;
  if (some(a.open)) {
    b = best_for(a);
    both = b.on;
  }
  if (some(both)) {
    End back = best_for(b);
    both = both && back.on && back.x == px && back.y == py && same(back.steep, steep) && back.towards == towards;
    Real other = piece_at(b.steep, b.x, b.y);
    ends.coded = select(both, packed_join(b.at - a.at, linked_of(other), steep, both && !both), ends.coded);
  }
  Real firm = linked_of(piece);
  Bool alone = a.on && !both && (a.open || !ends.alone.open);
  alone = alone && (firm > kFirm || (firm > kFirmCut && !ends.alone.on));
  ends.alone = chosen(alone, a, ends.alone);
  return ends;
}

// What is to be told of a pixel with such pieces: as outline_stroke.kernel.h has it.
FN Real join_of(Int px, Int py, Real steep, Real lower) {
  Bool any = is_piece(steep) || is_piece(lower);
  Real coded = Real(0.0f);
  if (some(any)) {
    Vec2 nowhere = Vec2(Real(0.0f), Real(0.0f));
    Ends ends = Ends(select(any, Real(kOnlyEnds), coded),
                     End(any && !any, any && !any, px, py, any, Real(0.0f), nowhere, nowhere, nowhere));
    for (int towards = -1; towards <= 1; towards += 2) {
      ends = joined(px, py, 0, steep, towards, ends);
      ends = joined(px, py, 1, lower, towards, ends);
    }
    coded = ends.coded;
    Bool alone = ends.alone.on && !has_join(bits_of(coded));
    if (some(alone)) {
      Target target = target_of(alone, ends.alone);
      coded = select(target.on, packed_join(target.apart, target.sure, ends.alone.steep, target.far), coded);
    }
    coded = select(steep < 0.0f || lower < 0.0f, -coded, coded);
  }
  return coded;
}
