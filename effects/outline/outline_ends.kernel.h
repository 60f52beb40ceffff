// How near pieces are to where their line ends. Only there outline_fit moves a line, and only to others that end near
// by, too: what goes on stays where it was found, and barbs on it are not drawn to it.
//
// outline_steep_ends, outline_flat_ends: 1 where a line ends, less before that, and 0 for what goes on for more rows
// than lines are fitted to; and for what is no flake, since it lies on two objects or far before what is behind it.
IN_REAL(depth)
IN_REAL(object_id)
IN_REAL(outline_steep_linked)
IN_REAL(outline_flat_linked)
OUT_REAL(outline_steep_ends)
OUT_REAL(outline_flat_ends)
FN Real steep_at(Int x, Int y) { return load_outline_steep_linked(x, y); }
FN Real flat_at(Int x, Int y) { return load_outline_flat_linked(x, y); }
#include "effects/outline/outline_end.kernel.h"
#include "effects/outline/outline_shift.kernel.h"

CONST float kFlat = 14.0f;  // pixel sizes, per pixel of stride, that one side of a flake lies before the other,
CONST float kDeep = 28.0f;  // and from which on it is none

// Whether a line ends within so many pixels.
FN Bool has_end(Bool asked, int around) {
  Real least = Real(0.0f);
  for (int j = -around; j <= around; ++j) {
    for (int i = -around; i <= around; ++i)
      least = min(least, min(near_outline_steep_linked(i, j), near_outline_flat_linked(i, j)));
    if (!some(asked && !(least < 0.0f))) return asked;
  }
  return asked && least < 0.0f;
}

// How far this pixel's piece is of a flake: it lies on one object, whose two sides are hardly one before the other.
FN Real flake_at(int lying) {
  int right = lying == 0 ? 1 : 0;
  Real depth1 = near_depth(0, 0);
  Real depth2 = near_depth(right, 1 - right);
  Real pixel = Real(F.ray_scale_x * float(C.stride));
  if (F.orthographic == 0) pixel = pixel * min(depth1, depth2);
  Real deep = abs(depth1 - depth2) / pixel;
  Real flake = clamp((kDeep - deep) * Real(1.0f / (kDeep - kFlat)), Real(0.0f), Real(1.0f));
  return select(near_object_id(0, 0) == near_object_id(right, 1 - right) && deep < kDeep, flake, Real(0.0f));
}

FN Real ends_near(Int px, Int py, Real piece, int lying) {
  int around = fit_rows();
  Bool asked = seen(piece);
  Real flake = flake_at(lying);
  asked = asked && flake > 0.0f;
  if (some(asked)) asked = has_end(asked, around);
  Real ends = Real(0.0f);
  if (!some(asked)) return ends;
  Bool steep = steep_of(lying);
  for (int side = -1; side <= 1; side += 2) {
    Real towards = Real(float(side));
    Along last = Along(asked, place_of(piece), slope_of(piece), px, py, steep, piece, Real(kLeastSeen));
    Real rows = Real(0.0f);
    for (int k = 1; k <= around; ++k) {
      if (!some(last.on)) continue;
      last = next_along(last, px, py, steep, Int(k * side), towards);
      rows = select(last.on, Real(float(k)), rows);
    }
    Bool inside = goes_inside(last, px, py, steep, to_int((rows + 1.0f) * towards), towards);
    ends = max(ends, select(last.on || !inside, Real(0.0f), counted(rows)));
  }
  return select(asked, ends * flake, Real(0.0f));
}

FN void outline_ends_pixel(Int px, Int py) {
  Real steep = near_outline_steep_linked(0, 0);
  Real lower = near_outline_flat_linked(0, 0);
  Real steep_ends = Real(0.0f);
  Real flat_ends = Real(0.0f);
  if (some(is_piece(steep))) steep_ends = ends_near(px, py, steep, 0);
  if (some(is_piece(lower))) flat_ends = ends_near(px, py, lower, 1);
  store_outline_steep_ends(steep_ends);
  store_outline_flat_ends(flat_ends);
}
