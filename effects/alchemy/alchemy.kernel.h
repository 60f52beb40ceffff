// Obscurance from sample points in a disc: the visible surface at each of them adds its height above the pixel's plane,
// weighted by distance. Based on [McGuire et al. 2011], equation 10, and on the falloff of [McGuire et al. 2012],
// equation 2.
//
// Positions are computed only with operations that round identically on every machine.
IN_REAL(depth)
IN_VECTOR(normal)
OUT_REAL(ao)

#include "kernel/angles.kernel.h"

// Returns the cosine and sine of the pixel's rotation of the points: [McGuire et al. 2012], "Sample pattern",
// 10 (3x ^ y + xy) radians.
FN Vec2 turn_at(Int px, Int py) {
  Uint x = to_uint(px);
  Uint y = to_uint(py);
  return direction_of_turn(share_of_one(((x * Uint(3u)) ^ (y + x * y)) * Uint(0x976fc894u)));
}

FN Real visibility_at(Int px, Int py, Real depth) {
  Vec3 position = view_position(px, py, depth);
  Vec3 normal = unit_normal(near_normal(0, 0), position);
  Vec2 turn = turn_at(px, py);
  Real spread = F.orthographic != 0 ? Real(1.0f) : depth;
  Real reach = clamp(Real(C.reach) / spread, Real(0.0f), Real(1e5f));
  Real x = to_real(px) + 0.5f;
  Real y = to_real(py) + 0.5f;
  Real sum = Real(0.0f);
  for (int i = 0; i < C.samples; ++i) {
    Real px_x = mad(turn.x, Real(C.points[2 * i]), turn.y * -C.points[2 * i + 1]) * reach;
    Real px_y = mad(turn.y, Real(C.points[2 * i]), turn.x * C.points[2 * i + 1]) * reach;
    Int column = to_int(floor(clamp(x + px_x, Real(0.0f), Real(float(F.width) - 0.5f))));
    Int row = to_int(floor(clamp(mad(px_y, Real(C.rows), y), Real(0.0f), Real(float(F.height) - 0.5f))));
    Real tap = load_depth(column, row);
    Vec3 way = view_position(column, row, tap) - position;
    Real squared = dot(way, way);
    Real height = max(mad(depth, Real(-C.bias), dot(way, normal)), Real(0.0f));
    Real term = height / (squared + C.epsilon);
    if (C.scalable != 0) {
      Real within = max(1.0f - squared / C.radius2, Real(0.0f));
      term = term * (within * within * within);
    }
    // Differs: taps add nothing on the background, or where the sum would not be finite.
    sum = sum + select(is_surface(tap) && squared < 1e30f, term, Real(0.0f));
  }
  Real open = max(mad(sum, Real(-C.factor), Real(1.0f)), Real(0.0f));
  if (C.contrast != 1.0f) open = pow(open, Real(C.contrast));
  return open;
}

#include "kernel/occlusion.kernel.h"

FN void alchemy_pixel(Int px, Int py) { store_visibility(px, py); }
