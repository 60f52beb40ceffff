// What both passes of `gaussian` share: one step of a 3x3 Gaussian, [1 2 1]/4 along one axis of the picture. Based on
// [Lajzer and Nottingham], "Pass 3"; the paper names the size and not the weights, which are the binomial ones here.
//
// Written as differences to the pixel itself, so that what is equal stays equal to the bit, and so that a neighbour
// that does not count leaves its weight to the pixel.
IN_REAL(depth)
IN_VECTOR(normal)
#include "kernel/surface.kernel.h"

// With `edges`, a neighbour counts fully up to this far off the pixel's plane, and not at all from twice that on. The
// next pixel of one surface is off by its curvature alone, which is far less; with 1, creases lose more of their shade
// than the noise that goes is worth.
CONST float kTolerancePx = 0.75f;

// How much the occlusion of the neighbour (i, j) pixels right and down belongs to this pixel.
FN Real belongs(int i, int j, Int px, Int py, Vec3 position, Vec3 normal) {
  Vec3 there = view_position(px + Int(i), py + Int(j), near_depth(i, j));
  return joint_of(surface_distance(position, normal, there, near_normal(i, j), kTolerancePx));
}

// The pixel's value joined with those of its neighbours, `after` being (i, j) pixels right and down, `before` as far to
// the other side.
FN Real joined(int i, int j, Int px, Int py, Real before, Real here_ao, Real after) {
  Real weight_before = Real(1.0f);
  Real weight_after = Real(1.0f);
  if (C.edges != 0) {
    Vec3 position = view_position(px, py, near_depth(0, 0));
    Vec3 normal = near_normal(0, 0);
    weight_before = belongs(-i, -j, px, py, position, normal);
    weight_after = belongs(i, j, px, py, position, normal);
  }
  Real change = mad(weight_before, before - here_ao, weight_after * (after - here_ao));
  return mad(change, Real(C.side), here_ao);
}
