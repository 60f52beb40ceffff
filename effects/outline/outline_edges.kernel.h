// Writes the edges along which lines are traced, between each pixel and its right and lower neighbours. They are breaks
// (of adjacent ones with the same sign, only the largest), and creases where normals turn more than at all neighbours
// within the window. A crease is placed where the normal is halfway between the normals at the ends of its window.
// An edge is stored as an integer (outline.h).
IN_REAL(depth)
IN_VECTOR(normal)
IN_REAL(outline_break_right)
IN_REAL(outline_break_below)
IN_REAL(outline_turn_right)
IN_REAL(outline_turn_below)
OUT_REAL(outline_edge_right)
OUT_REAL(outline_edge_below)
#include "effects/outline/outline_windows.kernel.h"
#include "kernel/surface.kernel.h"

// Returns the stored crease between the pixel s steps of (i, j) from this one and the next pixel in that direction.
FN Real turn_beside(int s, int i, int j) {
  return i != 0 ? near_outline_turn_right(s, 0) : near_outline_turn_below(0, s);
}
FN Real window_of(Real stored) { return floor(stored * (1.0f / kWindowUnit)); }
FN Real strength_of(Real stored) { return stored - window_of(stored) * kWindowUnit; }

FN Real edge_code(int kind, Real strength, Real place, Real offset) {
  Real code = mad(floor(min(strength, Real(kOutlineMaxStrength)) * 31.0f + 0.5f), Real(4.0f), Real(float(kind)));
  code = mad(floor(place * 127.0f + 0.5f), Real(512.0f), code);
  return mad(offset + float(kOutlineMaxWindow), Real(65536.0f), code);
}

// Returns the code of the edge at a break, or 0 if one of the adjacent breaks with the same sign is larger.
FN Real break_code(Real found, int i, int j) {
  Real before = break_beside(-1, i, j);
  Real after = break_beside(1, i, j);
  Real none = Real(0.0f);
  Bool is_smaller =
      (before * found > 0.0f && abs(before) >= abs(found)) || (after * found > 0.0f && abs(after) > abs(found));
  Real depth = select(is_smaller, none, edge_code(kOutlineDepth, abs(found), Real(0.5f), none));
  return select(abs(found) > kOutlineMaxStrength, edge_code(kOutlineId, abs(found), Real(0.5f), none), depth);
}

// Returns whether the crease between this pixel and the next is at least as strong as all creases before it and
// stronger than all after it, within its window and on the same surface.
FN Bool is_peak(Bool candidate, Real strength, Real window, int i, int j) {
  Bool before = candidate;
  Bool after = candidate;
  Real reach = max(window, Real(1.0f));
  for (int s = 1; s <= (C.max_window > 1 ? C.max_window : 1); ++s) {
    Bool near = reach >= float(s);
    before = before && near && break_beside(-s, i, j) == 0.0f && near_inside(-s * i, -s * j);
    after = after && near && break_beside(s, i, j) == 0.0f && near_inside((s + 1) * i, (s + 1) * j);
    if (!some(before || after)) break;
    candidate = candidate && !(before && strength_of(turn_beside(-s, i, j)) > strength) &&
                !(after && strength_of(turn_beside(s, i, j)) >= strength);
  }
  return candidate;
}

FN Real crease_code(Int px, Int py, Real stored, int i, int j) {
  Real strength = strength_of(stored);
  Real window = window_of(stored);
  Bool is_crease = is_peak(stored > 0.0f, strength, window, i, j);
  if (!some(is_crease)) return Real(0.0f);
  Int h = to_int(window);
  Int ax = px - Int(i) * h;
  Int ay = py - Int(j) * h;
  Int bx = px + Int(i) * (h + Int(1));
  Int by = py + Int(j) * (h + Int(1));
  // The crease is concave if inverse depth falls more slowly, or rises faster, after it than before.
  Real slope_before = inverse_depth(load_depth(ax, ay)) - inverse_depth(load_depth(ax - Int(i), ay - Int(j)));
  Real slope_after = inverse_depth(load_depth(bx + Int(i), by + Int(j))) - inverse_depth(load_depth(bx, by));
  Bool known = i != 0 ? load_outline_break_right(ax - Int(1), ay) == 0.0f && load_outline_break_right(bx, by) == 0.0f
                      : load_outline_break_below(ax, ay - Int(1)) == 0.0f && load_outline_break_below(bx, by) == 0.0f;
  if (C.convex == 0) is_crease = is_crease && (slope_after > slope_before || !known);
  if (C.concave == 0) is_crease = is_crease && !(slope_after > slope_before && known);
  Vec3 a = load_normal(ax, ay);
  Vec3 across = load_normal(bx, by) - a;
  Vec3 middle = (load_normal(bx, by) + a) * 0.5f;
  Real halfway = dot(across, middle);
  Real offset = Real(0.0f);
  Real place = Real(0.5f);
  Bool searching = is_crease && window > 0.0f;
  Real before = dot(across, near_normal(-C.max_window * i, -C.max_window * j));
  for (int s = -C.max_window; s <= C.max_window; ++s) {
    Real after = dot(across, near_normal((s + 1) * i, (s + 1) * j));
    Bool here = searching && window >= float(s < 0 ? -s : s) && (after > halfway || window == float(s));
    place = select(here, (halfway - before) / select(after > before, after - before, Real(1.0f)), place);
    offset = select(here, Real(float(s)), offset);
    searching = searching && !here;
    before = after;
  }
  place = clamp(place, Real(0.0f), Real(1.0f));
  return select(is_crease, edge_code(kOutlineCrease, strength, place, offset), Real(0.0f));
}

FN Real edge_at(Int px, Int py, int i, int j) {
  Real found = break_beside(0, i, j);
  Real stored = turn_beside(0, i, j);
  Real code = Real(0.0f);
  if (some(!(found == 0.0f))) code = select(found == 0.0f, code, break_code(found, i, j));
  if (some(stored > 0.0f)) code = select(stored > 0.0f, crease_code(px, py, stored, i, j), code);
  return code;
}

FN void outline_edges_pixel(Int px, Int py) {
  store_outline_edge_right(edge_at(px, py, 1, 0));
  store_outline_edge_below(edge_at(px, py, 0, 1));
}
