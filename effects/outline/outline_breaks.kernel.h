// Where one surface ends and another begins, between each pixel and its right and its lower neighbour: at another
// object or material, if these are asked for, at the background, and at depth discontinuities. Inverse depth (-depth in
// orthographic views) is affine in the picture on every plane, so that a plane seen at however low an angle predicts
// its neighbours exactly; a discontinuity is what both sides agree that they do not predict, in sizes of a pixel. A
// side predicts with the milder of its last two pixels' planes, since the last one before a silhouette is so steep that
// it explains anything, and with the measured slope, since interpolated normals of coarse meshes are not their
// surface's. Stored as strength in units of the threshold, at most kOutlineMaxStrength, or twice that between ids;
// below 0 where the pixel lies behind its neighbour. 0: one surface goes on.
IN_REAL(depth)
IN_VECTOR(normal)
IN_REAL(object_id)
IN_REAL(material_id)
OUT_REAL(outline_break_right)
OUT_REAL(outline_break_below)
#include "kernel/surface.kernel.h"

CONST float kMinFacing = 0.01f;     // cosine to the eye below which a normal tells no slope
CONST float kUnknownSlope = 1e30f;  // that of such a normal
CONST float kSure = 0.9f;           // share of a threshold that is not reached, however it is rounded

// How inverse depth changes by one pixel to the right (`right` 1) or down (0) on the plane of a pixel.
FN Real plane_slope(Int px, Int py, int i, int j, int right) {
  Vec3 n = near_normal(i, j);
  Real lean = right != 0 ? n.x * Real(F.ray_scale_x) : n.y * Real(F.ray_scale_y);
  Real facing = n.z;
  if (F.orthographic == 0) {
    facing = -dot(n, view_position(px + Int(i), py + Int(j), Real(1.0f)));
    lean = lean * inverse_depth(near_depth(i, j));
  }
  Bool tells = facing > kMinFacing;
  return select(tells, -lean / select(tells, facing, Real(1.0f)), Real(kUnknownSlope));
}

FN Bool same_object(int i, int j, int k, int l) {
  return near_object_id(i, j) == near_object_id(k, l) && is_surface(near_depth(i, j)) && is_surface(near_depth(k, l));
}

FN Real milder(Real a, Real b) { return select(abs(a) < abs(b), a, b); }

// What two sides agree on, above or below 0; or 0.
FN Real agreed(Real a, Real b) { return max(min(a, b), Real(0.0f)) + min(max(a, b), Real(0.0f)); }

// A step of inverse depth less what one side predicts: from the slopes of its last two pixels and the step between
// them, where it has two.
FN Real unpredicted(Real step, Bool two, Real last, Real before, Real measured, Real pixel) {
  Real bound = mad(abs(measured), Real(kMaxSteepening), pixel);
  Real slope = clamp(milder(before, last), -bound, bound);
  Real by_one = select(last < kUnknownSlope, step - last, step);
  return select(two, milder(step - slope, step - measured), by_one);
}

// The depth discontinuity between this pixel and its neighbour (i, j), in units of its threshold.
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
  Real of_first = unpredicted(step, before, plane_slope(px, py, 0, 0, i), plane_slope(px, py, -i, -j, i), step0, pixel);
  Real of_second =
      unpredicted(step, after, plane_slope(px, py, i, j, i), plane_slope(px, py, 2 * i, 2 * j, i), step2, pixel);
  Real gap = agreed(of_first, of_second);
  return gap / (max(pixel, Real(1e-30f)) * C.depth);
}

// Whether inverse depth bends at a pixel along (k, l) by as much as a discontinuity must. Depths are compared after
// multiplication by all three, to spare divisions; one that is none makes it true.
FN Bool bends(int i, int j, int k, int l) {
  Real d0 = near_depth(i - k, j - l);
  Real d1 = near_depth(i, j);
  Real d2 = near_depth(i + k, j + l);
  Real bend = d0 - (d1 + d1) + d2;
  Real bound = Real(F.ray_scale_x * C.depth * kOutlineMinStrength * kSure);
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
  Bool ends = !(near_object_id(-i, -j) == near_object_id(0, 0) && near_object_id(2 * i, 2 * j) == near_object_id(i, j));
  Bool maybe = both && !differs && (bends(0, 0, i, j) || bends(i, j, i, j) || ends);
  Real gap = Real(0.0f);
  if (some(maybe)) {
    gap = select(maybe, discontinuity(px, py, i, j), gap);
    Bool clear = abs(gap) > kOutlineMinStrength;
    found = select(clear, min(abs(gap), Real(kOutlineMaxStrength)), found);
  }
  // Below 0 behind: what is no surface lies behind all others.
  Bool behind = surface2 && (!surface1 || near_depth(0, 0) > near_depth(i, j));
  return select(behind, -found, found);
}

FN void outline_breaks_pixel(Int px, Int py) {
  store_outline_break_right(break_at(px, py, 1, 0));
  store_outline_break_below(break_at(px, py, 0, 1));
}
