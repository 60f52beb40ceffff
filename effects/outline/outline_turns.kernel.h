// Writes the strength of a possible crease between each pixel and its right and lower neighbours: the turn of the
// normals across a window, minus the turn of the surface beside the window over the same width, in that of several
// windows where it is the largest. Sharp and bevelled edges are both found, and round surfaces have none. At the
// surface's own silhouette some pixels must be left beside the window to measure. Normals in the middle of a window
// must be between those at its ends; otherwise it contains a vertex. Stored as strength + kWindowUnit times half of the
// window's width; 0: no crease. outline_edges chooses among neighbours.
IN_REAL(depth)
IN_VECTOR(normal)
IN_REAL(outline_break_right)
IN_REAL(outline_break_below)
OUT_REAL(outline_turn_right)
OUT_REAL(outline_turn_below)
#include "effects/outline/outline_windows.kernel.h"

CONST float kMaxStraying = 0.17f;   // max deviation of normals in a window's middle, relative to its turn
CONST float kRoundness = 0.5f;      // factor of the turn beside a window that is subtracted, on either side
CONST float kSoftRoundness = 2.0f;  // the same for a window wider than C.narrow

// Returns the next half width of a window: 0, 1, 2, 4, 6 and so on.
FN int wider(int h) { return h < 2 ? h + 1 : h + 2; }

FN Real square(Vec3 v) { return dot(v, v); }

// Returns whether n is on the way from a to b. turn2 is the square of the turn from a to b.
FN Bool on_the_way(Vec3 a, Vec3 n, Vec3 b, Real turn2) {
  Vec3 c = cross(a, b);
  Real off = dot(c, n);
  return off * off < turn2 * square(c) * (kMaxStraying * kMaxStraying);
}

// Returns the square of a side's turn per pixel: from its pixel with normal v to the last of `count` pixels, with
// normal `far`, or to the middle one of `few`, whichever is smaller, since there may be another crease. per_count and
// per_few are the inverse squares of the counts.
FN Real smaller_turn(Vec3 v, Vec3 far, Real per_count, Vec3 near, Real per_few) {
  return min(square(v - far) * per_count, square(v - near) * per_few);
}

// Returns smaller_turn of the side that begins s steps of (i, j) from this pixel and has `count` pixels left.
FN Real side_turn(Int px, Int py, Vec3 v, int s, int i, int j, Int count) {
  Int few = to_signed(to_uint(count + Int(1)) >> 1);
  Vec3 far = load_normal(px + Int(i) * (count + Int(s)), py + Int(j) * (count + Int(s)));
  Vec3 near = load_normal(px + Int(i) * (few + Int(s)), py + Int(j) * (few + Int(s)));
  Real per_count = Real(1.0f) / max(to_real(count * count), Real(1.0f));
  return smaller_turn(v, far, per_count, near, Real(1.0f) / max(to_real(few * few), Real(1.0f)));
}

// Returns the same for a side that has all `count` pixels.
FN Real whole_side_turn(Vec3 v, int s, int i, int j, int count) {
  int few = (count + 1) / 2;
  return smaller_turn(v, near_normal((s + count) * i, (s + count) * j), Real(1.0f / float(count * count)),
                      near_normal((s + few) * i, (s + few) * j), Real(1.0f / float(few * few)));
}

FN Real break_load(Int px, Int py, Int s, int i, int j) {
  return i != 0 ? load_outline_break_right(px + s, py) : load_outline_break_below(px, py + s);
}

FN Real turn_at(Int px, Int py, int i, int j) {
  Bool maybe = break_beside(0, i, j) == 0.0f && near_inside(i, j) && is_surface(near_depth(0, 0));
  if (!some(maybe)) return Real(0.0f);
  Real max_value = Real(0.0f);
  for (int h = 0; h <= C.max_window; h = wider(h)) {
    Vec3 across = near_normal((1 + h) * i, (1 + h) * j) - near_normal(-h * i, -h * j);
    max_value = max(max_value, dot(across, across));
  }
  Real min_value = Real(C.crease_chord);
  maybe = maybe && max_value >= min_value * min_value * (kOutlineMinStrength * kOutlineMinStrength);
  if (!some(maybe)) return Real(0.0f);
  // Number of pixels of the surface on either side, and whether it ends there in its own silhouette.
  int reach = 2 * C.max_window + 1;
  Real run_before = Real(float(reach));
  Real run_after = run_before;
  for (int s = reach; s > 0; --s) {
    run_before = select(break_beside(-s, i, j) == 0.0f, run_before, Real(float(s - 1)));
    run_after = select(break_beside(s, i, j) == 0.0f, run_after, Real(float(s - 1)));
  }
  Int place = i != 0 ? px : py;
  Int before = min(to_int(run_before), place);
  Int after = min(to_int(run_after), Int((i != 0 ? F.width : F.height) - 2) - place);
  Bool silhouette_before = maybe && !maybe;
  Bool silhouette_after = silhouette_before;
  if (some(maybe && (before < Int(reach) || after < Int(reach)))) {
    silhouette_before =
        before < place && before < Int(reach) && break_load(px, py, Int(0) - before - Int(1), i, j) < 0.0f;
    silhouette_after = after < Int((i != 0 ? F.width : F.height) - 2) - place && after < Int(reach) &&
                       break_load(px, py, after + Int(1), i, j) > 0.0f;
  }
  Vec3 n1 = near_normal(0, 0);
  Vec3 n2 = near_normal(i, j);
  Real best = Real(0.0f);
  Real coded = Real(0.0f);
  for (int h = 0; h <= C.max_window; h = wider(h)) {
    Vec3 a = near_normal(-h * i, -h * j);
    Vec3 b = near_normal((1 + h) * i, (1 + h) * j);
    Real turn2 = square(b - a);
    Real bound = min_value * max(best, Real(kOutlineMinStrength));
    Int left = min(before - Int(h), Int(h + 1));
    Int right = min(after - Int(h), Int(h + 1));
    Int silhouette_room = Int(h < 4 ? 1 : h / 2);
    Int room = Int(h > 0 ? 1 : 0);
    Bool on = maybe && turn2 >= bound * bound && left + right > Int(0) &&
              left >= select(silhouette_before, silhouette_room, room) &&
              right >= select(silhouette_after, silhouette_room, room);
    if (!some(on)) continue;
    Real of_left = whole_side_turn(a, h, -i, -j, h + 1);
    Real of_right = whole_side_turn(b, h + 1, i, j, h + 1);
    if (some(on && (left < Int(h + 1) || right < Int(h + 1)))) {
      of_left = side_turn(px, py, a, h, -i, -j, max(left, Int(0)));
      of_right = side_turn(px, py, b, h + 1, i, j, max(right, Int(0)));
    }
    Real sides = sqrt(select(left > Int(0), of_left, of_right)) + sqrt(select(right > Int(0), of_right, of_left));
    float width = float(2 * h + 1);
    Real strength = sqrt(turn2) - sides * (width * (width <= C.narrow ? kRoundness : kSoftRoundness));
    strength = strength * Real((1.0f - C.coarser * float(h)) / C.crease_chord);
    on = on && strength > best;
    if (h > 0) on = on && on_the_way(a, n1, b, turn2) && on_the_way(a, n2, b, turn2);
    best = select(on, strength, best);
    coded = select(on, Real(float(h) * kWindowUnit), coded);
  }
  return select(best > kOutlineMinStrength, min(best, Real(kWindowUnit - 1.0f)) + coded, Real(0.0f));
}

FN void outline_turns_pixel(Int px, Int py) {
  store_outline_turn_right(turn_at(px, py, 1, 0));
  store_outline_turn_below(turn_at(px, py, 0, 1));
}
