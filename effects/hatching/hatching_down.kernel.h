// Fifth dispatch of `hatching`: filters directions along columns, and computes the direction of the crossing lines, at
// a right angle on the surface. All have length 1, or 0 where there is none.
IN_REAL(hatching_row_x)
IN_REAL(hatching_row_y)
OUT_REAL(hatching_x)
OUT_REAL(hatching_y)
OUT_REAL(hatching_cross_x)
OUT_REAL(hatching_cross_y)

CONST bool kAlongRows = false;
FN Vec2 direction_at(int i, int j) { return Vec2(near_hatching_row_x(i, j), near_hatching_row_y(i, j)); }
#include "effects/hatching/hatching_filter.kernel.h"
#include "effects/hatching/hatching_tangents.kernel.h"

FN Vec2 unit_or_zero(Vec2 v) {
  Real squared = dot(v, v);
  Bool usable = squared > 1e-12f && is_finite(squared);
  Real scale = select(usable, Real(1.0f) / sqrt(select(usable, squared, Real(1.0f))), Real(0.0f));
  return Vec2(finite_or_zero(v.x), finite_or_zero(v.y)) * scale;
}

// Returns the direction at a right angle to `direction` on the surface, both as (cos 2a, sin 2a) on the picture.
FN Vec2 crossing(Vec2 direction, Vec3 position, Vec3 normal) {
  Tangents t = tangents_of(position, normal);
  Vec2 step = half_angle(direction);
  Vec3 along = cross(normal, t.x * step.x + t.y * step.y);
  return on_picture(t, dot(along, t.x), dot(along, t.y));
}

FN void hatching_down_pixel(Int px, Int py) {
  Bool surface = is_surface(near_depth(0, 0));
  Vec3 position = view_position(px, py, select(surface, near_depth(0, 0), Real(1.0f)));
  Vec3 normal = unit_normal(near_normal(0, 0), position);
  Vec2 direction = unit_or_zero(filtered(px, py));
  Vec2 other = crossing(direction, position, normal);
  Bool known = surface && dot(direction, direction) > 0.5f;
  Real none = Real(0.0f);
  store_hatching_x(select(known, direction.x, none));
  store_hatching_y(select(known, direction.y, none));
  store_hatching_cross_x(select(known, finite_or_zero(other.x), none));
  store_hatching_cross_y(select(known, finite_or_zero(other.y), none));
}
