// Measures how many of a pixel's neighbours show its surface: `traced_joined`, the mean of their joint weights and its
// own, 1 on an open surface. Where they are few, as on leaves and edges, the filter has few rays to average, and the
// pixel itself needs more.
OUT_REAL(traced_joined)
#include "kernel/joint.kernel.h"

FN void traced_joined_pixel(Int px, Int py) {
  Real depth = near_depth(0, 0);
  Vec3 position = view_position(px, py, depth);
  Vec3 normal = near_normal(0, 0);
  Real sum = Real(1.0f);
  for (int k = -1; k <= 1; k += 2) {
    sum = sum + joint_weight(2 * k, 0, px, py, position, normal, C.distance, C.turn);
    sum = sum + joint_weight(0, 2 * k, px, py, position, normal, C.distance, C.turn);
    sum = sum + joint_weight(k, 1, px, py, position, normal, C.distance, C.turn);
    sum = sum + joint_weight(k, -1, px, py, position, normal, C.distance, C.turn);
  }
  store_traced_joined(sum * Real(1.0f / 9.0f));
}
