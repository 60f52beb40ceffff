// Code that the kernels of `resample` share that borrow from the first sample: the weights of its nearest pixels, by
// their distance in the picture and by depth and normal, as in `upsample` [Kopf et al. 2007].
//
// A further sample of a picture shows points between those of the first, at edges only. What changes slowly along a
// surface, and takes long or needs the neighbouring pixels, is not computed again for these points: occlusion, indirect
// light, and shadows that a filter has softened. A point gets the weighted mean of the nine nearest pixels of the first
// sample. Those on its surface, and among these the nearest ones, have the largest weights.

#include "kernel/surface.kernel.h"

// Depth and normal of the first sample are those that were captured, since effects may change `depth`.

IN_REAL(depth)
IN_VECTOR(normal)
IN_REAL(other_resample_depth)
IN_VECTOR(other_normal)

// Factor of the weights by depth. They decide if no pixel fits; if any fits, they are too small to be visible.
CONST float kMinFit = 1e-6f;
// Min squared distance, in pixels, by which weights are divided.
CONST float kMinSquare = 0.05f;

// Returns the weight of the first sample's pixel (i, j) to the right and below.
FN Real weight_of(int i, int j, Int px, Int py) {
  Vec3 position = view_position(px, py, near_depth(0, 0));
  Vec3 normal = near_normal(0, 0);
  Real depth = near_other_resample_depth(i, j);
  Vec3 normal_there = near_other_normal(i, j);
  // Its view-space position: this sample shows it `right` pixels to the left of and `below` above the pixel's centre.
  Real spread = F.orthographic != 0 ? Real(1.0f) : depth;
  Real column = to_real(px) + (float(i) + 0.5f - C.right);
  Real row = to_real(py) + (float(j) + 0.5f - C.below);
  Vec3 there = Vec3(mad(column, Real(F.ray_scale_x), Real(F.ray_offset_x)) * spread,
                    mad(row, Real(F.ray_scale_y), Real(F.ray_offset_y)) * spread, -depth);
  Real distance = surface_distance(position, normal, there, normal_there, C.distance);
  Real turned = (1.0f - dot(normal, normal_there)) * Real(C.turn);
  Real misfit = max(max(distance, turned), Real(1.0f));
  // max may ignore NaN.
  misfit = select(is_finite(turned), min(misfit, Real(kOtherSurface)), Real(kOtherSurface));
  Real inverse = Real(1.0f) / (misfit * misfit);
  Real fit = max(same_surface_weight(misfit), inverse * inverse * kMinFit);
  float x = float(i) - C.right;
  float y = float(j) - C.below;
  return select(near_inside(i, j), fit / max(Real(x * x + y * y), Real(kMinSquare)), Real(0.0f));
}
