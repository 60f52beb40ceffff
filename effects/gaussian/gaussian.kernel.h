// Shared by both dispatches of `gaussian`: one step of a 3x3 Gaussian, [1 2 1]/4 along one axis of the picture. Based
// on [Lajzer and Nottingham], "Pass 3". The paper gives the size but no weights; here they are the binomial ones.
//
// The kernel adds weighted differences to the pixel's own value. So a constant stays bitwise identical, and the pixel
// itself gets the weight of a neighbour that does not count.
IN_REAL(depth)
IN_VECTOR(normal)
#include "kernel/surface.kernel.h"

// With `edges`, a neighbour has full weight up to this distance from the pixel's plane, and none at twice the distance
// or more. On one surface, the next pixel is off the plane only by curvature, which is far less. At a tolerance of 1,
// the loss of occlusion at creases would outweigh the removed noise.
CONST float kTolerancePx = 0.75f;

// Returns the weight, 0 to 1, of the pixel (i, j) to the right and below: 1 if it is on the same surface.
FN Real neighbour_weight(int i, int j, Int px, Int py, Vec3 position, Vec3 normal) {
  Vec3 neighbour = view_position(px + Int(i), py + Int(j), near_depth(i, j));
  return same_surface_weight(surface_distance(position, normal, neighbour, near_normal(i, j), kTolerancePx));
}

// Returns the value of a pixel, filtered with those of its two neighbours: `after` is (i, j) to the right and below,
// `before` is opposite.
FN Real blurred(int i, int j, Int px, Int py, Real before, Real here_ao, Real after) {
  Real weight_before = Real(1.0f);
  Real weight_after = Real(1.0f);
  if (C.edges != 0) {
    Vec3 position = view_position(px, py, near_depth(0, 0));
    Vec3 normal = near_normal(0, 0);
    weight_before = neighbour_weight(-i, -j, px, py, position, normal);
    weight_after = neighbour_weight(i, j, px, py, position, normal);
  }
  Real change = mad(weight_before, before - here_ao, weight_after * (after - here_ao));
  return mad(change, Real(C.side), here_ao);
}
