// Obscurance from sample points in a disc: the visible surface at each of them adds its height above the pixel's plane,
// weighted by distance. Based on [McGuire et al. 2011], equation 10, and on the falloff of [McGuire et al. 2012],
// equation 2.
//
// Positions are computed only with operations that round identically on every machine.
IN_REAL(depth)
IN_VECTOR(normal)
OUT_REAL(ao)

#include "kernel/angles.kernel.h"

// Returns the cosine and sine of the angle by which a pixel rotates its points: 10 (3x ^ y + xy) radians [McGuire et
// al. 2012, "Sample pattern"].
FN Vec2 rotation_at(Int px, Int py) {
  Uint x = to_uint(px);
  Uint y = to_uint(py);
  return direction_of_turn(unit_real(((x * Uint(3u)) ^ (y + x * y)) * Uint(0x976fc894u)));
}

FN Real visibility_at(Int px, Int py, Real depth) {
  Vec3 position = view_position(px, py, depth);
  Vec3 normal = unit_normal(near_normal(0, 0), position);
  Vec2 rotation = rotation_at(px, py);
  Real spread = F.orthographic != 0 ? Real(1.0f) : depth;
  Real radius_px = clamp(Real(C.radius_px) / spread, Real(0.0f), Real(1e5f));
  Real center_x = to_real(px) + 0.5f;
  Real center_y = to_real(py) + 0.5f;
  Real sum = Real(0.0f);
  for (int i = 0; i < C.samples; ++i) {
    Real offset_x = mad(rotation.x, Real(C.points[2 * i]), rotation.y * -C.points[2 * i + 1]) * radius_px;
    Real offset_y = mad(rotation.y, Real(C.points[2 * i]), rotation.x * C.points[2 * i + 1]) * radius_px;
    Int column = to_int(floor(clamp(center_x + offset_x, Real(0.0f), Real(float(F.width) - 0.5f))));
    Int row = to_int(
        floor(clamp(mad(offset_y, Real(C.rows_per_column), center_y), Real(0.0f), Real(float(F.height) - 0.5f))));
    Real tap_depth = load_depth(column, row);
    Vec3 to_tap = view_position(column, row, tap_depth) - position;
    Real distance2 = dot(to_tap, to_tap);
    Real height = max(mad(depth, Real(-C.bias), dot(to_tap, normal)), Real(0.0f));
    Real term = height / (distance2 + C.epsilon);
    if (C.scalable != 0) {
      Real falloff = max(1.0f - distance2 / C.radius2, Real(0.0f));
      term = term * (falloff * falloff * falloff);
    }
    // Differs: taps on the background add nothing, nor do taps so far away that the sum would not be finite.
    sum = sum + select(is_surface(tap_depth) && distance2 < 1e30f, term, Real(0.0f));
  }
  Real visibility = max(mad(sum, Real(-C.factor), Real(1.0f)), Real(0.0f));
  if (C.contrast != 1.0f) visibility = pow(visibility, Real(C.contrast));
  return visibility;
}

#include "kernel/occlusion.kernel.h"

FN void alchemy_pixel(Int px, Int py) { store_visibility(px, py); }
