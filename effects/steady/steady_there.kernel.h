// Finds the surface points of a frame in another frame of the sequence, if nothing but the camera moves: writes column,
// row and depth there. Pixel centres have integer coordinates. A depth of 0: not in front of the camera.
#include "kernel/surface.kernel.h"
IN_REAL(depth)
OUT_VECTOR(there)

CONST float kMaxPlace = 1e9f;

FN Real sum_there(Vec3 p, float x, float y, float z, float w) {
  return mad(p.x, Real(x), mad(p.y, Real(y), mad(p.z, Real(z), Real(w))));
}

FN void steady_there_pixel(Int px, Int py) {
  Real depth = near_depth(0, 0);
  Vec3 p = view_position(px, py, depth);
  Real away = Real(0.0f) - sum_there(p, C.z[0], C.z[1], C.z[2], C.z[3]);
  Bool visible = is_surface(depth) && away > 0.0f;
  Real spread = F.orthographic != 0 ? Real(1.0f) : 1.0f / select(visible, away, Real(1.0f));
  Real x = sum_there(p, C.x[0], C.x[1], C.x[2], C.x[3]) * spread;
  Real y = sum_there(p, C.y[0], C.y[1], C.y[2], C.y[3]) * spread;
  Real column = (x - C.ray_offset_x) * Real(1.0f / C.ray_scale_x) - 0.5f;
  Real row = (y - C.ray_offset_y) * Real(1.0f / C.ray_scale_y) - 0.5f;
  // Not for places far outside, whose rounding is undefined.
  visible = visible && abs(column) < kMaxPlace && abs(row) < kMaxPlace && away < kMaxPlace * kMaxPlace;
  store_there(Vec3(select(visible, column, Real(0.0f)), select(visible, row, Real(0.0f)),
                   select(visible, away * float(C.usable), Real(0.0f))));
}
