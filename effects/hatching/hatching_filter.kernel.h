// Filters directions along rows or columns. The kernel that includes it must first define:
//   kAlongRows    whether the filter runs along rows (true) or columns (false)
//   direction_at  returns the weighted direction of the pixel (i, j) to the right and below
//
// Taps count where they show the same surface: not far from the plane of the pixel, which allows for curved surfaces,
// and with a similar normal. Their weights fall with the square of the distance, to 0 beyond the last tap.
IN_REAL(depth)
IN_VECTOR(normal)
#include "kernel/surface.kernel.h"

CONST int kTaps = 12;           // on each side
CONST float kMinCosine = 0.8f;  // taps have a weight if their normals differ by less than 37 degrees
CONST float kCurved = 0.25f;    // distance from the plane that a tap may have, relative to its distance

FN Vec2 filtered(Int px, Int py) {
  Vec3 position = view_position(px, py, near_depth(0, 0));
  Vec3 normal = unit_normal(near_normal(0, 0), position);
  Vec2 sum = direction_at(0, 0);
  for (int k = -kTaps; k <= kTaps; ++k) {
    int offset = int(float(k) * C.tap_px + (k < 0 ? -0.5f : 0.5f));
    if (offset == 0) continue;
    int right = kAlongRows ? offset : 0;
    int below = kAlongRows ? 0 : offset;
    Vec3 there = view_position(px + Int(right), py + Int(below), near_depth(right, below));
    Vec3 other = unit_normal(near_normal(right, below), there);
    float tolerance = 1.0f + kCurved * float(offset < 0 ? -offset : offset);
    Real weight = same_surface_weight(surface_distance(position, normal, there, other, tolerance));
    weight = weight * clamp((dot(normal, other) - kMinCosine) * (1.0f / (1.0f - kMinCosine)), Real(0.0f), Real(1.0f));
    weight = select(near_inside(right, below), weight, Real(0.0f));
    weight = weight * (1.0f - float(k * k) / float((kTaps + 1) * (kTaps + 1)));
    sum = sum + direction_at(right, below) * weight;
  }
  return sum;
}
