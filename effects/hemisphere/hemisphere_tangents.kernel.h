// Writes the first vector of the basis of each pixel's sample points, in view space, to show their rotation. As in
// figure 5 of [Colliander and Törnquist 2015].
IN_REAL(depth)
IN_VECTOR(normal)
OUT_VECTOR(tangent)

#include "effects/hemisphere/hemisphere_basis.kernel.h"

FN void hemisphere_tangents_pixel(Int px, Int py) {
  Real depth = near_depth(0, 0);
  Bool surface = depth > 0.0f && is_finite(depth);
  depth = select(surface, depth, Real(1.0f));
  Vec3 normal = unit_normal(near_normal(0, 0), view_position(px, py, depth));
  Vec3 tangent = rotated_tangent(normal, noise_at(px, py));
  store_tangent(select(surface, tangent, Vec3(Real(0.0f), Real(0.0f), Real(0.0f))));
}
