// Horizon-based ambient occlusion: in several directions of the picture, the kernel searches the depths for the
// horizon; what is between the tangent plane and the horizon is occluded. Based on [Bavoil et al. 2008], section 3:
// elevations are angles to the picture plane, measured by their sine.
// Differs: a tap is the centre of a pixel, which is not exactly in the direction that is searched, and on a steep plane
// the elevation of the tangent changes quickly with direction. So the kernel measures how far a tap is above the
// tangent in the tap's own direction, and adds that angle to the elevation of the tangent in the direction that is
// searched.
//
// Positions are computed only with operations that round identically on every machine.
IN_REAL(depth)
IN_VECTOR(normal)
OUT_REAL(ao)

#include "kernel/angles.kernel.h"

CONST float kMinFacing = 1e-3f;  // min z of the normal; smaller values are clamped, to keep the slope finite

// Angles are vectors of their cosine and sine.

// Returns the sine, or 1 past the zenith.
FN Real sine_to_zenith(Vec2 angle) { return select(angle.x > 0.0f, angle.y, Real(1.0f)); }

// Returns the sum of two angles.
FN Vec2 sum_of(Vec2 a, Vec2 b) { return Vec2(mad(a.x, b.x, a.y * -b.y), mad(a.y, b.x, a.x * b.y)); }

// Returns the angle of a tap above the tangent plane, within the plane through the view axis and the tap. `normal` is
// perpendicular to the tangent plane, of any length, and `lift` is dot(to_tap, normal).
FN Vec2 angle_above_tangent(Vec3 to_tap, Vec3 normal, Real lift, Real distance2) {
  Real across2 = mad(to_tap.x, to_tap.x, to_tap.y * to_tap.y);
  Real fall = mad(normal.x, to_tap.x, normal.y * to_tap.y);
  Real tangent2 = mad(normal.z * normal.z, across2, fall * fall);  // the slope is -fall / (normal.z * sqrt(across2))
  Real scale = rsqrt(max(tangent2, Real(1e-30f))) * rsqrt(max(distance2, Real(1e-30f)));
  return Vec2(mad(normal.z, across2, -to_tap.z * fall) * scale, lift * sqrt(across2) * scale);
}

FN Real visibility_at(Int px, Int py, Real depth) {
  Vec3 position = view_position(px, py, depth);
  Vec3 normal = unit_normal(near_normal(0, 0), position);
  normal.z = max(normal.z, Real(kMinFacing));
  Real min_lift = normal.z * C.bias_sin;  // per distance: lower taps are below the angle bias in any direction
  Real spread = F.orthographic != 0 ? Real(1.0f) : depth;
  Real radius_px = clamp(Real(C.radius_px) / spread, Real(0.0f), Real(1e5f));
  Real x = to_real(px) + 0.5f;
  Real y = to_real(py) + 0.5f;
  // "we randomly rotate the directions and jitter the samples" [section 3.2].
  Uint random_bits = scrambled(to_uint(px) ^ scrambled(to_uint(py) + Uint(0x9e3779b9u)));
  Real jitter = unit_real(scrambled(random_bits + Uint(1u)));
  Vec2 direction = direction_of_turn(unit_real(random_bits) * Real(C.turn_fraction));
  Real sum = Real(0.0f);
  for (int i = 0; i < C.directions; ++i) {
    // `slope` is that of the tangent plane along the direction.
    Real slope = -mad(normal.x, direction.x, normal.y * direction.y) / normal.z;
    Real slope_cos = rsqrt(mad(slope, slope, Real(1.0f)));
    Vec2 tangent = Vec2(slope_cos, slope * slope_cos);
    Real horizon = sine_to_zenith(sum_of(tangent, Vec2(Real(C.bias_cos), Real(C.bias_sin))));
    for (int k = 0; k < C.steps; ++k) {
      Real offset_px = mad((jitter + float(k)) * Real(C.one_over_steps), radius_px, Real(1.0f));
      Int column = to_int(floor(clamp(mad(direction.x, offset_px, x), Real(0.0f), Real(float(F.width) - 0.5f))));
      Int row = to_int(floor(
          clamp(mad(direction.y * offset_px, Real(C.rows_per_column), y), Real(0.0f), Real(float(F.height) - 0.5f))));
      Real tap_depth = load_depth(column, row);
      Vec3 to_tap = view_position(column, row, tap_depth) - position;
      Real distance2 = dot(to_tap, to_tap);
      Bool counts = distance2 < C.radius2 && distance2 > 0.0f && is_surface(tap_depth);
      Real lift = dot(to_tap, normal);
      counts = counts && lift > 0.0f && lift * lift >= min_lift * min_lift * distance2;
      if (!some(counts)) continue;
      Vec2 above = angle_above_tangent(to_tap, normal, lift, select(counts, distance2, Real(1.0f)));
      Real sine = sine_to_zenith(sum_of(tangent, above));
      Real raised_by = max(sine - horizon, Real(0.0f));
      // A tap that raises the horizon is weighted by 1 - r^2 [section 3.3].
      Real weight = C.attenuation != 0 ? 1.0f - distance2 / C.radius2 : Real(1.0f);
      sum = sum + select(counts, raised_by * weight, Real(0.0f));
      horizon = select(counts, max(horizon, sine), horizon);
    }
    direction = Vec2(mad(direction.x, Real(C.turn_cos), direction.y * -C.turn_sin),
                     mad(direction.y, Real(C.turn_cos), direction.x * C.turn_sin));
  }
  return max(mad(sum, Real(-C.factor), Real(1.0f)), Real(0.0f));
}

#include "kernel/occlusion.kernel.h"

FN void hbao_pixel(Int px, Int py) { store_visibility(px, py); }
