// Shared by both kernels of `upsample`: the weights of the nearest pixels at reduced resolution, by their distance in
// the picture and by depth and normal [Kopf et al. 2007].
//
// A pixel at reduced resolution is the upper left pixel of its block of factor x factor pixels, the block's corner: its
// depth and normal are read there, and that pixel itself takes its value unchanged.
IN_REAL(depth)
IN_VECTOR(normal)
IN_REAL(reduced_ao)
OUT_REAL(ao)
#include "kernel/surface.kernel.h"

CONST float kOutside = 2e6f;  // misfit of a pixel outside the picture
// Where no pixel fits, the nearest in depth has the largest weight. Where any fits, this is too small to be visible.
CONST float kMinFit = 1e-6f;
// If the weights of the four nearest pixels sum to less than this, at silhouettes and on leaves and wires that none of
// the four shows, the technique computes the pixel itself (`leave`), or the sixteen nearest pixels are used.
CONST float kFew = 0.1f;
CONST float kMinSquare = 1e-2f;  // of a distance in blocks: the nearest pixel except its own is a quarter block away

// Returns the column or row at which the block of a pixel in column or row `at` begins.
FN Int block_start(Int at) { return to_signed(to_uint(at) & to_uint(Int(-C.factor))); }

// Returns the misfit between this pixel and the corner of block (i, j) to the right and below: by the parameters
// distance and angle, up to which pixels fit fully; 1 to kOtherSurface.
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

// Returns how well that corner fits this pixel, 0 to 1. `any`: whether any lane shows a surface.
FN Real corner_fit(int i, int j, Int px, Int py, Vec3 position, Vec3 normal, bool any) {
  if (any) return same_surface_weight(misfit_of(i, j, px, py, position, normal));
  // Background only compares depths.
  Bool inside =
      block_start(px) + Int(i * C.factor) < Int(F.width) && block_start(py) + Int(j * C.factor) < Int(F.height);
  return select(inside && !is_surface(corner_depth(C.factor, i, j)), Real(1.0f), Real(0.0f));
}

// Returns the offset of the pixel from its block's corner, in blocks.
FN Vec2 offset_of(Int px, Int py) {
  Real fraction = Real(1.0f / float(C.factor));
  return Vec2(to_real(px - block_start(px)) * fraction, to_real(py - block_start(py)) * fraction);
}

// Returns the weights of the corners right, below, and right below; the rest is that of the block's own corner. All are
// 0 at that corner itself, and x is -1 where too few of the four fit.
FN Vec3 shares_of(Int px, Int py) {
  Vec2 at = offset_of(px, py);
  Vec3 position = view_position(px, py, near_depth(0, 0));
  Vec3 normal = near_normal(0, 0);
  bool any = some(is_surface(near_depth(0, 0)));
  Real own = (1.0f - at.x) * (1.0f - at.y) * corner_fit(0, 0, px, py, position, normal, any);
  Real right = at.x * (1.0f - at.y) * corner_fit(1, 0, px, py, position, normal, any);
  Real below = Real(0.0f);
  Real both = Real(0.0f);
  if (some(at.y > 0.0f)) {
    below = (1.0f - at.x) * at.y * corner_fit(0, 1, px, py, position, normal, any);
    both = at.x * at.y * corner_fit(1, 1, px, py, position, normal, any);
  }
  Real sum = own + right + (below + both);
  Real scale = Real(1.0f) / max(sum, Real(kFew));
  Bool corner = at.x + at.y == Real(0.0f);  // regardless of its fit: a NaN normal fits nowhere
  Bool few = sum < kFew && !corner;
  return Vec3(select(few, Real(-1.0f), right * scale), below * scale, both * scale);
}

// Returns the occlusion of a pixel that too few fit: that of background is known.
FN Real missing_ao() { return select(is_surface(near_depth(0, 0)), Real(kMissing), Real(1.0f)); }

// Returns the weight of the block (i, j) to the right and below, if sixteen are used.
FN Real wide_weight(int i, int j, Int px, Int py) {
  Vec2 at = offset_of(px, py);
  Real x = at.x - float(i);
  Real y = at.y - float(j);
  Real misfit = misfit_of(i, j, px, py, view_position(px, py, near_depth(0, 0)), near_normal(0, 0));
  Real inverse = Real(1.0f) / (misfit * misfit);
  Real joint = max(same_surface_weight(misfit), inverse * inverse * kMinFit);
  return select(misfit < kOutside, joint / max(mad(x, x, y * y), Real(kMinSquare)), Real(0.0f));
}

// Returns the occlusion of the block (i, j) to the right and below.
FN Real small_ao(int i, int j) { return clean_ao(block_reduced_ao(C.factor, i, j)); }

// Returns the change of the own block's occlusion by its neighbours.
FN Real change_of_ao(Vec3 fractions, Real own) {
  return (small_ao(1, 0) - own) * fractions.x + (small_ao(0, 1) - own) * fractions.y +
         (small_ao(1, 1) - own) * fractions.z;
}
