// One step of a 3x3 Gaussian, [1 2 1]/4 along one axis of the picture. Neighbours are clamped to the picture. Based
// on [Lajzer and Nottingham], "Pass 3". The paper gives the size but no weights; here they are the binomial ones.
//
// The kernel adds weighted differences to the pixel's own value. So a constant stays bitwise identical, and the pixel
// itself gets the weight of a neighbour that does not count.
// KERNEL gaussian_across: ALONG_ROWS=1 AO=ao NEW_AO=gaussian_ao
// KERNEL gaussian_down: ALONG_ROWS=0 AO=gaussian_ao NEW_AO=ao
IN_REAL_AS(source_ao, AO)
OUT_REAL_AS(new_ao, NEW_AO)
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

FN void gaussian_pixel(Int px, Int py) {
  int i = ALONG_ROWS;  // to the next pixel
  int j = 1 - ALONG_ROWS;
  Real before = clean_ao(near_source_ao(-i, -j));
  Real own = clean_ao(near_source_ao(0, 0));
  Real after = clean_ao(near_source_ao(i, j));
  Real weight_before = Real(1.0f);
  Real weight_after = Real(1.0f);
  if (C.edges != 0) {
    Vec3 position = view_position(px, py, near_depth(0, 0));
    Vec3 normal = near_normal(0, 0);
    weight_before = neighbour_weight(-i, -j, px, py, position, normal);
    weight_after = neighbour_weight(i, j, px, py, position, normal);
  }
  Real change = mad(weight_before, before - own, weight_after * (after - own));
  store_new_ao(mad(change, Real(C.side), own));
}
