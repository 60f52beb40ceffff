// Third dispatch of `hatching`: in which direction lines run.
//
// A direction without sign is stored as the vector (cos 2a, sin 2a), whose length is its weight, with a the angle on the
// picture from right to down. So opposite directions are equal and means are meaningful.
//
// The principal directions follow from the normals alone: the tangents P_x and P_y are the steps
// from a pixel to the next on the plane of the pixel, and the change of the normal along them gives the second
// fundamental form. With (X, Y) the traceless part of the shape operator in an orthonormal basis and H its mean, the
// direction of the curvature of larger magnitude is that of H (X, Y), whose length is a quarter of k1^2 - k2^2.
IN_REAL(depth)
IN_VECTOR(normal)
OUT_REAL(hatching_raw_x)
OUT_REAL(hatching_raw_y)
#include "effects/hatching/hatching_tangents.kernel.h"
#include "effects/hatching/hatching_thin.kernel.h"
#include "kernel/surface.kernel.h"

CONST float kFixedWeight = 0.08f;     // of the fixed direction, relative to a distinct curvature
CONST float kRound = 0.35f;           // ratio of the difference of curvatures to their mean that is distinct
CONST float kMaxCurvature = 1e15f;    // so that squares remain finite

// The normal of a neighbour minus this one's, or 0 where the surface ends before it.
struct Step {
  Vec3 change;
  Real count;
};
FN Step step_to(int i, int j, Bool ends, Int px, Int py, Vec3 normal) {
  Vec3 other = unit_normal(near_normal(i, j), view_position(px + Int(i), py + Int(j), near_depth(i, j)));
  Vec3 none = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  return Step(select(ends, none, other - normal), select(ends, Real(0.0f), Real(1.0f)));
}

// Returns the change of the normal per pixel, from the steps to both neighbours.
FN Vec3 slope(Step before, Step after) {
  return (after.change - before.change) * (Real(1.0f) / max(before.count + after.count, Real(1.0f)));
}

// Returns the weighted direction of the curvature with larger magnitude. n_x, n_y: change of the normal per pixel.
FN Vec2 curvature_direction(Tangents t, Vec3 n_x, Vec3 n_y, Real pixel) {
  Real l = dot(t.x, n_x);
  Real m = Real(0.5f) * (dot(t.x, n_y) + dot(t.y, n_x));
  Real q = dot(t.y, n_y);
  Real tilt = t.xy / t.xx;
  Real a = l / t.xx;
  Real b = (m - tilt * l) / t.area;
  Real c = (q - (m * 2.0f - tilt * l) * tilt) * (t.xx / (t.area * t.area));
  Real limit = Real(kMaxCurvature) / pixel;
  Real x = clamp((a - c) * 0.5f, -limit, limit) * pixel;
  Real y = clamp(b, -limit, limit) * pixel;
  Real mean = clamp((a + c) * 0.5f, -limit, limit) * pixel;
  x = select(mean < 0.0f, -x, x);
  y = select(mean < 0.0f, -y, y);
  Real w = sqrt(x * x + y * y);
  Real inverse = Real(1.0f) / max(w, Real(1e-30f));
  Vec2 turned = half_angle(Vec2(x * inverse, y * inverse));  // from t.x towards t.y
  Real root = sqrt(t.xx);
  Vec2 direction = on_picture(t, turned.x * root, (turned.x * t.xy + turned.y * t.area) / root);
  // Where both curvatures are nearly equal, as on a sphere, their difference is that of the triangles.
  Real distinct = w * abs(mean) / (C.curvature_unit * C.curvature_unit);
  distinct = distinct * (w * w / max(mad(mean * mean, Real(kRound * kRound), w * w), Real(1e-30f)));
  // Narrow bevels and bumps, which are smaller than the distance between lines, do not turn the lines beside them.
  Real narrow = (w + abs(mean)) * C.detail_px;
  return direction * (distinct / ((distinct + 1.0f) * mad(narrow, narrow, Real(1.0f))));
}

FN void hatching_field_pixel(Int px, Int py) {
  Real depth = near_depth(0, 0);
  Bool surface = is_surface(depth);
  Vec3 position = view_position(px, py, select(surface, depth, Real(1.0f)));
  Vec3 normal = unit_normal(near_normal(0, 0), position);
  Step left = step_to(-1, 0, ends_right(-1, 0), px, py, normal);
  Step right = step_to(1, 0, ends_right(0, 0), px, py, normal);
  Step above = step_to(0, -1, ends_below(0, -1), px, py, normal);
  Step below = step_to(0, 1, ends_below(0, 0), px, py, normal);
  Tangents t = tangents_of(position, normal);
  Vec2 sum = fixed_direction(t, normal) * Real(kFixedWeight);
  if (C.curvature != 0) {
    Vec2 curved = curvature_direction(t, slope(left, right), slope(above, below), pixel_size(depth));
    sum = sum + curved + thin_direction();
  }
  Real none = Real(0.0f);
  store_hatching_raw_x(select(surface, finite_or_zero(sum.x), none));
  store_hatching_raw_y(select(surface, finite_or_zero(sum.y), none));
}
