// Finds the edges of a picture. `resample_edge` is 2 where neighbouring pixels show different surfaces, 1 where one
// surface has a crease, a step of albedo or emission, or the border of a hard shadow, and 0 elsewhere.
IN_REAL(depth)
IN_VECTOR(normal)
IN_COLOR(albedo)
IN_COLOR(emission)
IN_REAL(shadow)
IN_REAL(shadow1)
IN_REAL(shadow2)
IN_REAL(shadow3)
IN_REAL(shadow4)
IN_REAL(shadow5)
IN_REAL(shadow6)
IN_REAL(shadow7)
OUT_REAL(resample_edge)
OUT_REAL(resample_depth)
#include "kernel/surface.kernel.h"

// Returns the max difference of the square roots of two colours. Above 1, where displays are white, all is equal.
FN Real color_step(Vec3 a, Vec3 b) {
  Real red = abs(sqrt(clamp(a.x, Real(0.0f), Real(1.0f))) - sqrt(clamp(b.x, Real(0.0f), Real(1.0f))));
  Real green = abs(sqrt(clamp(a.y, Real(0.0f), Real(1.0f))) - sqrt(clamp(b.y, Real(0.0f), Real(1.0f))));
  Real blue = abs(sqrt(clamp(a.z, Real(0.0f), Real(1.0f))) - sqrt(clamp(b.z, Real(0.0f), Real(1.0f))));
  return max(red, max(green, blue));
}

// Returns the value of `resample_edge` for the border with the pixel (i, j) to the right and below.
FN Real edge_with(int i, int j, Int px, Int py, Vec3 position, Vec3 normal) {
  Real depth = near_depth(i, j);
  Vec3 other_normal = near_normal(i, j);
  Vec3 there = view_position(px + Int(i), py + Int(j), depth);
  Bool both_empty = !is_surface(depth) && !is_surface(-position.z);
  Bool differs = surface_distance(position, normal, there, other_normal, C.distance) > 1.0f;
  Bool steps = Real(1.0f) - dot(normal, other_normal) > C.crease ||
               color_step(near_albedo(i, j), near_albedo(0, 0)) > C.albedo ||
               color_step(near_emission(i, j), near_emission(0, 0)) > C.albedo;
  Real edge = select(differs, Real(2.0f), select(steps, Real(1.0f), Real(0.0f)));
  return select(near_inside(i, j) && !both_empty, edge, Real(0.0f));
}

FN Real max_step(Real own, Real left, Real right, Real above, Real below) {
  return max(max(abs(own - left), abs(own - right)), max(abs(own - above), abs(own - below)));
}

// Returns the max difference of a hard shadow from the four neighbours.
FN Real shadow_step() {
  Real step = Real(0.0f);
  if ((C.hard_shadows & 1) != 0)
    step = max(step, max_step(near_shadow(0, 0), near_shadow(-1, 0), near_shadow(1, 0), near_shadow(0, -1),
                              near_shadow(0, 1)));
  if ((C.hard_shadows & 2) != 0)
    step = max(step, max_step(near_shadow1(0, 0), near_shadow1(-1, 0), near_shadow1(1, 0), near_shadow1(0, -1),
                              near_shadow1(0, 1)));
  if ((C.hard_shadows & 4) != 0)
    step = max(step, max_step(near_shadow2(0, 0), near_shadow2(-1, 0), near_shadow2(1, 0), near_shadow2(0, -1),
                              near_shadow2(0, 1)));
  if ((C.hard_shadows & 8) != 0)
    step = max(step, max_step(near_shadow3(0, 0), near_shadow3(-1, 0), near_shadow3(1, 0), near_shadow3(0, -1),
                              near_shadow3(0, 1)));
  if ((C.hard_shadows & 16) != 0)
    step = max(step, max_step(near_shadow4(0, 0), near_shadow4(-1, 0), near_shadow4(1, 0), near_shadow4(0, -1),
                              near_shadow4(0, 1)));
  if ((C.hard_shadows & 32) != 0)
    step = max(step, max_step(near_shadow5(0, 0), near_shadow5(-1, 0), near_shadow5(1, 0), near_shadow5(0, -1),
                              near_shadow5(0, 1)));
  if ((C.hard_shadows & 64) != 0)
    step = max(step, max_step(near_shadow6(0, 0), near_shadow6(-1, 0), near_shadow6(1, 0), near_shadow6(0, -1),
                              near_shadow6(0, 1)));
  if ((C.hard_shadows & 128) != 0)
    step = max(step, max_step(near_shadow7(0, 0), near_shadow7(-1, 0), near_shadow7(1, 0), near_shadow7(0, -1),
                              near_shadow7(0, 1)));
  return step;
}

FN void resample_mark_pixel(Int px, Int py) {
  Vec3 position = view_position(px, py, near_depth(0, 0));
  Vec3 normal = near_normal(0, 0);
  Real edge = max(max(edge_with(-1, 0, px, py, position, normal), edge_with(1, 0, px, py, position, normal)),
                  max(edge_with(0, -1, px, py, position, normal), edge_with(0, 1, px, py, position, normal)));
  if (C.hard_shadows != 0) edge = select(shadow_step() > C.shadow, max(edge, Real(1.0f)), edge);
  store_resample_edge(edge);
  Real depth = near_depth(0, 0);
  store_resample_depth(select(is_surface(depth), depth, Real(0.0f)));
}
