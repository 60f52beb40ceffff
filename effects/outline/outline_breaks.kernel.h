// Detects breaks between each pixel and its right and lower neighbours: places where one surface ends, at another
// object or material (if enabled), at the background, or at a depth discontinuity. On every plane inverse depth
// (-depth in orthographic views) is affine in the picture, so a plane predicts its neighbours exactly, even at grazing
// angles. A discontinuity is the part of a depth step that neither side predicts, in pixel sizes. Each side predicts by
// the slope measured there, since coarse meshes have inaccurate normals, and by the smaller slope of its last two
// pixels' planes, since the last pixel before a silhouette is so steep that it would predict any step. A break is
// stored as its strength in units of the threshold: at most kOutlineMaxStrength, or twice that between ids or at the
// background; negative where the pixel is behind its neighbour; 0 where one surface continues.
IN_REAL(depth)
IN_VECTOR(normal)
IN_REAL(object_id)
IN_REAL(material_id)
OUT_REAL(outline_break_right)
OUT_REAL(outline_break_below)
#include "kernel/surface.kernel.h"

CONST float kMinFacing = 0.01f;      // min cosine between normal and view direction at which the slope is computed
CONST float kUnknownSlope = 1e30f;   // slope for a normal below kMinFacing
CONST float kBelowThreshold = 0.9f;  // factor of a threshold that leaves room for rounding errors

// Returns the change of inverse depth per pixel to the right (right = 1) or down (right = 0) on the plane of the pixel
// (i, j) pixels from this one; kUnknownSlope if the plane is seen edge-on or from behind.
FN Real plane_slope(Int px, Int py, int i, int j, int right) {
  Vec3 n = near_normal(i, j);
  Real lean = right != 0 ? n.x * Real(F.ray_scale_x) : n.y * Real(F.ray_scale_y);
  Real facing = n.z;
  if (F.orthographic == 0) {
    facing = -dot(n, view_position(px + Int(i), py + Int(j), Real(1.0f)));
    lean = lean * inverse_depth(near_depth(i, j));
  }
  Bool is_reliable = facing > kMinFacing;
  return select(is_reliable, -lean / select(is_reliable, facing, Real(1.0f)), Real(kUnknownSlope));
}

FN Bool same_object(int i, int j, int k, int l) {
  return near_object_id(i, j) == near_object_id(k, l) && is_surface(near_depth(i, j)) && is_surface(near_depth(k, l));
}

FN Real smaller_magnitude(Real a, Real b) { return select(abs(a) < abs(b), a, b); }

// Returns the one of smaller magnitude if both have the same sign, else 0.
FN Real agreed(Real a, Real b) { return max(min(a, b), Real(0.0f)) + min(max(a, b), Real(0.0f)); }

// Returns the part of a step of inverse depth that one side does not predict. `last` and `before` are the slopes of its
// last two pixels, `measured` the step between these. If `two` is false, the side has only one pixel.
FN Real unpredicted_step(Real step, Bool two, Real last, Real before, Real measured, Real pixel) {
  Real bound = mad(abs(measured), Real(kMaxSteepening), pixel);
  Real slope = clamp(smaller_magnitude(before, last), -bound, bound);
  Real by_one = select(last < kUnknownSlope, step - last, step);
  return select(two, smaller_magnitude(step - slope, step - measured), by_one);
}

// Returns the depth discontinuity between this pixel and its neighbour (i, j), in units of its threshold.
FN Real discontinuity(Int px, Int py, int i, int j) {
  Real c0 = inverse_depth(near_depth(-i, -j));
  Real c1 = inverse_depth(near_depth(0, 0));
  Real c2 = inverse_depth(near_depth(i, j));
  Real c3 = inverse_depth(near_depth(2 * i, 2 * j));
  Bool before = same_object(0, 0, -i, -j) && near_inside(-i, -j);
  Bool after = same_object(i, j, 2 * i, 2 * j) && near_inside(2 * i, 2 * j);
  Real step0 = c1 - c0;
  Real step = c2 - c1;
  Real step2 = c3 - c2;
  Real pixel = Real(F.ray_scale_x);
  if (F.orthographic == 0) pixel = pixel * min(c1, c2);
  Real first_gap =
      unpredicted_step(step, before, plane_slope(px, py, 0, 0, i), plane_slope(px, py, -i, -j, i), step0, pixel);
  Real second_gap =
      unpredicted_step(step, after, plane_slope(px, py, i, j, i), plane_slope(px, py, 2 * i, 2 * j, i), step2, pixel);
  Real gap = agreed(first_gap, second_gap);
  return gap / (max(pixel, Real(1e-30f)) * C.depth);
}

// Returns whether the slope of inverse depth along (k, l) changes at pixel (i, j) by at least the threshold of a
// discontinuity. Both sides of the comparison are multiplied by the three depths, to avoid divisions. Returns true if a
// depth is invalid.
FN Bool bends(int i, int j, int k, int l) {
  Real d0 = near_depth(i - k, j - l);
  Real d1 = near_depth(i, j);
  Real d2 = near_depth(i + k, j + l);
  Real bend = d0 - (d1 + d1) + d2;
  Real bound = Real(F.ray_scale_x * C.depth * kOutlineMinStrength * kBelowThreshold);
  if (F.orthographic == 0) {
    bend = mad(d0, d1 - d2 - d2, d1 * d2) * max(d0, max(d1, d2));
    bound = bound * (d0 * d1 * d2);
  }
  return !(abs(bend) < bound);
}

FN Real break_at(Int px, Int py, int i, int j) {
  Bool surface1 = is_surface(near_depth(0, 0));
  Bool surface2 = is_surface(near_depth(i, j));
  Bool inside = near_inside(i, j);
  Bool both = surface1 && surface2 && inside;
  Bool differs = !both;
  if (C.objects != 0) differs = differs || !(near_object_id(0, 0) == near_object_id(i, j));
  if (C.materials != 0) differs = differs || !(near_material_id(0, 0) == near_material_id(i, j));
  differs = differs && (surface1 || surface2) && inside;
  Real found = select(differs, Real(2.0f * kOutlineMaxStrength), Real(0.0f));
  Bool ids_change =
      !(near_object_id(-i, -j) == near_object_id(0, 0) && near_object_id(2 * i, 2 * j) == near_object_id(i, j));
  Bool candidate = both && !differs && (bends(0, 0, i, j) || bends(i, j, i, j) || ids_change);
  Real gap = Real(0.0f);
  if (some(candidate)) {
    gap = select(candidate, discontinuity(px, py, i, j), gap);
    Bool is_break = abs(gap) > kOutlineMinStrength;
    found = select(is_break, min(abs(gap), Real(kOutlineMaxStrength)), found);
  }
  // Negative: the pixel is behind its neighbour. Background is behind all surfaces.
  Bool behind = surface2 && (!surface1 || near_depth(0, 0) > near_depth(i, j));
  return select(behind, -found, found);
}

FN void outline_breaks_pixel(Int px, Int py) {
  store_outline_break_right(break_at(px, py, 1, 0));
  store_outline_break_below(break_at(px, py, 0, 1));
}
