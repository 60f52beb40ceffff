// Joint weights of a pixel and its neighbours in the kernel dialect. A filter with several rounds reads the same
// weights again and again: they are computed once, in traced_joints.kernel.h, and kept in one plane.
//
// `traced_joints` holds 8 weights of kJointBits bits, 0 to kMaxJoint: those of the pixels 1, 2, 4 and 8 to the right,
// then those of the pixels 1, 2, 4 and 8 below, from the lowest bits up. As an integer below 2^24 it is exact as a
// float. The weight of two pixels is stored with the left or upper one.

#include "kernel/surface.kernel.h"

IN_REAL(traced_joints)

// Returns the weight in a plane value of the pixel 1 << power to the right, or below if !along_row.
FN Real joint_of(Real packed, int power, bool along_row) {
  int place = along_row ? power : power + kJointPowers;
  Uint weight = (to_uint(to_int(packed)) >> (kJointBits * place)) & to_uint(Int(kMaxJoint));
  return to_real(to_signed(weight));
}

// Returns the weight of the pixel that is 1 << power to the left, or above if !along_row.
FN Real joint_before(int power, bool along_row) {
  int i = along_row ? -(1 << power) : 0;
  int j = along_row ? 0 : -(1 << power);
  return select(near_inside(i, j), joint_of(near_traced_joints(i, j), power, along_row), Real(0.0f));
}
