// Decides which neighbours of a pixel show its surface: `traced_joints`, as joints.kernel.h reads it.
OUT_REAL(traced_joints)
#include "kernel/joint.kernel.h"

FN void traced_joints_pixel(Int px, Int py) {
  Vec3 position = view_position(px, py, near_depth(0, 0));
  Vec3 normal = near_normal(0, 0);
  Real packed = Real(0.0f);
  for (int place = 2 * kJointPowers - 1; place >= 0; --place) {
    bool along_row = place < kJointPowers;
    int step = 1 << (along_row ? place : place - kJointPowers);
    Real weight =
        joint_weight(along_row ? step : 0, along_row ? 0 : step, px, py, position, normal, C.distance, C.turn);
    packed = mad(packed, Real(float(kMaxJoint + 1)), floor(mad(weight, Real(float(kMaxJoint)), Real(0.5f))));
  }
  store_traced_joints(packed);
}
