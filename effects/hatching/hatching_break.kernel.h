// Second dispatch of `hatching`: where surfaces end, and with them lines, between neighbours: kHatchingBreak...
IN_REAL(depth)
IN_VECTOR(normal)
IN_REAL(object_id)
OUT_REAL(hatching_break)
#include "kernel/surface.kernel.h"

CONST float kMaxStepPx = 2.0f;      // neighbours on a surface are off its plane by less than this
CONST float kMinFoldCosine = 0.8f;  // lines end where normals of neighbours differ by 37 degrees or more

// Returns whether the pixel (i, j) to the right and below shows the same surface.
FN Bool goes_on(int i, int j, Int px, Int py, Vec3 position, Vec3 normal) {
  Vec3 there = view_position(px + Int(i), py + Int(j), near_depth(i, j));
  Vec3 other = unit_normal(near_normal(i, j), there);
  Bool same = surface_distance(position, normal, there, other, kMaxStepPx) <= 1.0f;
  return same && dot(normal, other) > kMinFoldCosine && abs(near_object_id(i, j) - near_object_id(0, 0)) < 0.5f;
}

FN void hatching_break_pixel(Int px, Int py) {
  Real depth = near_depth(0, 0);
  Bool surface = is_surface(depth);
  Vec3 position = view_position(px, py, select(surface, depth, Real(1.0f)));
  Vec3 normal = unit_normal(near_normal(0, 0), position);
  Bool right = goes_on(1, 0, px, py, position, normal);
  Bool below = goes_on(0, 1, px, py, position, normal);
  Real none = Real(0.0f);
  Real ends = select(right, none, Real(1.0f)) + select(below, none, Real(2.0f));
  store_hatching_break(select(surface, ends, Real(3.0f)));
}
