// Writes the first vector of the basis in which each pixel's sample points lie, in view space, to show their rotation.
// [Colliander and Törnquist 2015], figure 5.
IN_REAL(depth)
IN_VECTOR(normal)
OUT_VECTOR(tangent)

#include "effects/hemisphere/hemisphere_basis.kernel.h"

FN void hemisphere_tangents_pixel(Int px, Int py) {
  Real depth = near_depth(0, 0);
  Bool surface = depth > 0.0f && is_finite(depth);
  depth = select(surface, depth, Real(1.0f));
  Vec3 normal = unit_normal(near_normal(0, 0), view_position(px, py, depth));
  Vec3 tangent = turned_tangent(normal, noise_at(px, py));
  store_tangent(select(surface, tangent, Vec3(Real(0.0f), Real(0.0f), Real(0.0f))));
}
