// Writes the strength of a possible crease between each pixel and its right and lower neighbours: the turn of the
// normals across a window, minus the turn of the surface beside the window over the same width. Of several windows, the
// one with the largest result counts. So sharp and bevelled edges are found, but round surfaces have none. At its own
// silhouette, the surface must have some pixels beside the window. Normals in the middle of a window must be in the
// plane of those at its ends; otherwise the window contains a vertex. The stored value is strength + kWindowUnit * half
// width of the window; 0: no crease. outline_edges then selects the strongest among neighbours.
IN_REAL(depth)
IN_VECTOR(normal)
IN_REAL(outline_break_right)
IN_REAL(outline_break_below)
OUT_REAL(outline_turn_right)
OUT_REAL(outline_turn_below)
#include "effects/outline/outline_windows.kernel.h"

CONST float kMaxDeviation = 0.17f;  // max deviation of the normals in a window's middle, relative to its turn
CONST float kRoundness = 0.5f;      // factor of the turn on either side of a window that is subtracted
CONST float kWideRoundness = 2.0f;  // the same for a window wider than C.narrow

// Returns the next half width of a window: 0, 1, 2, 4, 6 and so on.
FN int wider(int h) { return h < 2 ? h + 1 : h + 2; }

FN Real square(Vec3 v) { return dot(v, v); }

// Returns whether the normal n is close to the plane of a and b. turn2 is the squared turn from a to b.
FN Bool is_coplanar(Vec3 a, Vec3 n, Vec3 b, Real turn2) {
  Vec3 c = cross(a, b);
  Real off = dot(c, n);
  return off * off < turn2 * square(c) * (kMaxDeviation * kMaxDeviation);
}

// Returns the squared turn per pixel on one side of a window, whose first pixel has the normal v. It is measured to the
// last of `count` pixels, with normal `far`, and to the one in the middle, after `few` pixels, with normal `near`. The
// smaller result counts, since there may be another crease. per_count and per_few are 1 / count^2 and 1 / few^2.
FN Real smaller_turn(Vec3 v, Vec3 far, Real per_count, Vec3 near, Real per_few) {
  return min(square(v - far) * per_count, square(v - near) * per_few);
}

// Returns smaller_turn for the side that begins s steps of (i, j) from this pixel and has `count` pixels.
FN Real side_turn(Int px, Int py, Vec3 v, int s, int i, int j, Int count) {
  Int few = to_signed(to_uint(count + Int(1)) >> 1);
  Vec3 far = load_normal(px + Int(i) * (count + Int(s)), py + Int(j) * (count + Int(s)));
  Vec3 near = load_normal(px + Int(i) * (few + Int(s)), py + Int(j) * (few + Int(s)));
  Real per_count = Real(1.0f) / max(to_real(count * count), Real(1.0f));
  return smaller_turn(v, far, per_count, near, Real(1.0f) / max(to_real(few * few), Real(1.0f)));
}

// Returns the same if `count` is the same for all lanes.
FN Real whole_side_turn(Vec3 v, int s, int i, int j, int count) {
  int few = (count + 1) / 2;
  return smaller_turn(v, near_normal((s + count) * i, (s + count) * j), Real(1.0f / float(count * count)),
                      near_normal((s + few) * i, (s + few) * j), Real(1.0f / float(few * few)));
}

FN Real break_load(Int px, Int py, Int s, int i, int j) {
  return i != 0 ? load_outline_break_right(px + s, py) : load_outline_break_below(px, py + s);
}

FN Real turn_at(Int px, Int py, int i, int j) {
  Bool candidate = break_beside(0, i, j) == 0.0f && near_inside(i, j) && is_surface(near_depth(0, 0));
  if (!some(candidate)) return Real(0.0f);
  Real max_value = Real(0.0f);
  for (int h = 0; h <= C.max_window; h = wider(h)) {
    Vec3 across = near_normal((1 + h) * i, (1 + h) * j) - near_normal(-h * i, -h * j);
    max_value = max(max_value, dot(across, across));
  }
  Real min_value = Real(C.crease_chord);
  candidate = candidate && max_value >= min_value * min_value * (kOutlineMinStrength * kOutlineMinStrength);
  if (!some(candidate)) return Real(0.0f);
  // Counts the pixels of the surface on either side, and finds out whether it ends there at its own silhouette.
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
  Bool silhouette_before = Bool(false);
  Bool silhouette_after = silhouette_before;
  if (some(candidate && (before < Int(reach) || after < Int(reach)))) {
    silhouette_before =
        before < place && before < Int(reach) && break_load(px, py, Int(0) - before - Int(1), i, j) < 0.0f;
    silhouette_after = after < Int((i != 0 ? F.width : F.height) - 2) - place && after < Int(reach) &&
                       break_load(px, py, after + Int(1), i, j) > 0.0f;
  }
  Vec3 n1 = near_normal(0, 0);
  Vec3 n2 = near_normal(i, j);
  Real best = Real(0.0f);
  Real window_code = Real(0.0f);
  for (int h = 0; h <= C.max_window; h = wider(h)) {
    Vec3 a = near_normal(-h * i, -h * j);
    Vec3 b = near_normal((1 + h) * i, (1 + h) * j);
    Real turn2 = square(b - a);
    Real bound = min_value * max(best, Real(kOutlineMinStrength));
    Int left = min(before - Int(h), Int(h + 1));
    Int right = min(after - Int(h), Int(h + 1));
    Int silhouette_room = Int(h < 4 ? 1 : h / 2);
    Int room = Int(h > 0 ? 1 : 0);
    Bool valid = candidate && turn2 >= bound * bound && left + right > Int(0) &&
                 left >= select(silhouette_before, silhouette_room, room) &&
                 right >= select(silhouette_after, silhouette_room, room);
    if (!some(valid)) continue;
    Real left_rate2 = whole_side_turn(a, h, -i, -j, h + 1);
    Real right_rate2 = whole_side_turn(b, h + 1, i, j, h + 1);
    if (some(valid && (left < Int(h + 1) || right < Int(h + 1)))) {
      left_rate2 = side_turn(px, py, a, h, -i, -j, max(left, Int(0)));
      right_rate2 = side_turn(px, py, b, h + 1, i, j, max(right, Int(0)));
    }
    Real sides =
        sqrt(select(left > Int(0), left_rate2, right_rate2)) + sqrt(select(right > Int(0), right_rate2, left_rate2));
    float width = float(2 * h + 1);
    Real strength = sqrt(turn2) - sides * (width * (width <= C.narrow ? kRoundness : kWideRoundness));
    strength = strength * Real((1.0f - C.window_penalty * float(h)) / C.crease_chord);
    valid = valid && strength > best;
    if (h > 0) valid = valid && is_coplanar(a, n1, b, turn2) && is_coplanar(a, n2, b, turn2);
    best = select(valid, strength, best);
    window_code = select(valid, Real(float(h) * kWindowUnit), window_code);
  }
  return select(best > kOutlineMinStrength, min(best, Real(kWindowUnit - 1.0f)) + window_code, Real(0.0f));
}

FN void outline_turns_pixel(Int px, Int py) {
  store_outline_turn_right(turn_at(px, py, 1, 0));
  store_outline_turn_below(turn_at(px, py, 0, 1));
}
