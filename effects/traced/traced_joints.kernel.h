// Decides which neighbours of a pixel show its surface: `traced_joints`, as joints.kernel.h reads it.
OUT_REAL(traced_joints)
#include "kernel/joint.kernel.h"

FN void traced_joints_pixel(Int px, Int py) {
  Vec3 position = view_position(px, py, near_depth(0, 0));
  Vec3 normal = near_normal(0, 0);
  Real packed = Real(0.0f);
  for (int power = 3; power >= 0; --power) {
    Real weight = joint_weight(0, 1 << power, px, py, position, normal, C.distance, C.turn);
    packed = mad(packed, Real(8.0f), floor(mad(weight, Real(7.0f), Real(0.5f))));
  }
  for (int power = 3; power >= 0; --power) {
    Real weight = joint_weight(1 << power, 0, px, py, position, normal, C.distance, C.turn);
    packed = mad(packed, Real(8.0f), floor(mad(weight, Real(7.0f), Real(0.5f))));
  }
  store_traced_joints(packed);
}
