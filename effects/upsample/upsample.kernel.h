// Code that both kernels of `upsample` share: computes the weights of the nearest pixels at reduced resolution by their
// distance in the picture and by depth and normal [Kopf et al. 2007].
//
// A pixel at reduced resolution corresponds to the corner of a block: the upper left one of factor x factor pixels. Its
// depth and normal are those of the corner, and the corner takes its value unchanged.
IN_REAL(depth)
IN_VECTOR(normal)
IN_REAL(reduced_ao)
OUT_REAL(ao)
#include "kernel/surface.kernel.h"

CONST float kOutside = 2e6f;  // misfit of a pixel outside the picture
// Factor of the weights by depth. They decide if no pixel fits; if any fits, they are too small to be visible.
CONST float kMinFit = 1e-6f;
// Min sum of the weights of the four nearest pixels. It is lower at silhouettes, and on leaves and wires that none of
// the four shows. There the technique computes the pixel itself (`leave`), or the sixteen nearest pixels are used.
CONST float kMinWeight = 0.1f;
// Min squared distance, in blocks, by which weights are divided: less than that of a quarter of a block.
CONST float kMinSquare = 1e-2f;

// Returns the first column (row) of the block that contains column (row) `at`.
FN Int block_start(Int at) { return to_signed(to_uint(at) & to_uint(Int(-C.factor))); }

// Returns the misfit of this pixel and the corner of the block i blocks right and j blocks down: the larger of their
// distance and their angle, relative to the parameters `distance` and `angle`. 1 if they fit fully, up to
// kOtherSurface; kOutside if the corner is outside the picture.
FN Real misfit_of(int i, int j, Int px, Int py, Vec3 position, Vec3 normal) {
  Int x = block_start(px) + Int(i * C.factor);
  Int y = block_start(py) + Int(j * C.factor);
  Real depth = corner_depth(C.factor, i, j);
  Vec3 other_normal = corner_normal(C.factor, i, j);
  Real distance = surface_distance(position, normal, view_position(x, y, depth), other_normal, C.distance);
  Real turned = (1.0f - dot(normal, other_normal)) * Real(C.turn);
  Bool inside = x >= Int(0) && y >= Int(0) && x < Int(F.width) && y < Int(F.height);
  Real misfit = max(max(distance, turned), Real(1.0f));
  // max may ignore NaN.
  misfit = select(is_finite(turned), min(misfit, Real(kOtherSurface)), Real(kOtherSurface));
  misfit = select(!is_surface(-position.z) && !is_surface(depth), Real(1.0f), misfit);
  return select(inside, misfit, Real(kOutside));
}

// Returns how well the same corner fits this pixel, 0 to 1. `any` tells whether any lane shows a surface.
FN Real corner_fit(int i, int j, Int px, Int py, Vec3 position, Vec3 normal, bool any) {
  if (any) return same_surface_weight(misfit_of(i, j, px, py, position, normal));
  // All lanes show background: the corner fits if it does too.
  Bool inside =
      block_start(px) + Int(i * C.factor) < Int(F.width) && block_start(py) + Int(j * C.factor) < Int(F.height);
  return select(inside && !is_surface(corner_depth(C.factor, i, j)), Real(1.0f), Real(0.0f));
}

// Returns the offset of the pixel from its block's corner, in blocks.
FN Vec2 offset_of(Int px, Int py) {
  Real fraction = Real(1.0f / float(C.factor));
  return Vec2(to_real(px - block_start(px)) * fraction, to_real(py - block_start(py)) * fraction);
}

// Returns the weights of the corners to the right, below, and to the lower right. The corner of the pixel's own block
// has the weight 1 minus their sum. All three are 0 at that corner itself. x is -1 if the four fit too little
// (kMinWeight).
FN Vec3 corner_weights(Int px, Int py) {
  Vec2 at = offset_of(px, py);
  Vec3 position = view_position(px, py, near_depth(0, 0));
  Vec3 normal = near_normal(0, 0);
  bool any = some(is_surface(near_depth(0, 0)));
  Real own = (1.0f - at.x) * (1.0f - at.y) * corner_fit(0, 0, px, py, position, normal, any);
  Real right = at.x * (1.0f - at.y) * corner_fit(1, 0, px, py, position, normal, any);
  Real below = Real(0.0f);
  Real diagonal = Real(0.0f);
  if (some(at.y > 0.0f)) {
    below = (1.0f - at.x) * at.y * corner_fit(0, 1, px, py, position, normal, any);
    diagonal = at.x * at.y * corner_fit(1, 1, px, py, position, normal, any);
  }
  Real sum = own + right + (below + diagonal);
  Real scale = Real(1.0f) / max(sum, Real(kMinWeight));
  Bool corner = at.x + at.y == Real(0.0f);  // regardless of its fit: a NaN normal fits nowhere
  Bool too_few = sum < kMinWeight && !corner;
  return Vec3(select(too_few, Real(-1.0f), right * scale), below * scale, diagonal * scale);
}

// Returns what `ao` is set to if the technique shall compute the pixel: kMissing, or 1 for background.
FN Real missing_ao() { return select(is_surface(near_depth(0, 0)), Real(kMissing), Real(1.0f)); }

// Returns the weight of the block i blocks right and j blocks down, if sixteen blocks are used.
FN Real wide_weight(int i, int j, Int px, Int py) {
  Vec2 at = offset_of(px, py);
  Real x = at.x - float(i);
  Real y = at.y - float(j);
  Real misfit = misfit_of(i, j, px, py, view_position(px, py, near_depth(0, 0)), near_normal(0, 0));
  Real inverse = Real(1.0f) / (misfit * misfit);
  Real fit = max(same_surface_weight(misfit), inverse * inverse * kMinFit);
  return select(misfit < kOutside, fit / max(mad(x, x, y * y), Real(kMinSquare)), Real(0.0f));
}

// Returns the reduced `ao` of the block i blocks right and j blocks down.
FN Real ao_of_block(int i, int j) { return clean_ao(block_reduced_ao(C.factor, i, j)); }

// Returns the difference between the weighted mean of the four corners' `ao` and `own`, the own block's `ao`.
FN Real change_of_ao(Vec3 weights, Real own) {
  return (ao_of_block(1, 0) - own) * weights.x + (ao_of_block(0, 1) - own) * weights.y +
         (ao_of_block(1, 1) - own) * weights.z;
}
