// Evaluates the ambient light of LightingConstants for a normal.

FN Vec3 shape_factor(int k) { return Vec3(Real(C.shape_r[k]), Real(C.shape_g[k]), Real(C.shape_b[k])); }

// Returns the ambient light that an unoccluded white surface with normal n reflects: spherical harmonics up to the
// second degree [Ramamoorthi and Hanrahan 2001]. Never below 0.
FN Vec3 ambient_at_normal(Vec3 n) {
  Vec3 sum = Vec3(Real(C.ambient_r), Real(C.ambient_g), Real(C.ambient_b));
  if (C.shaped == 0) return sum;
  sum = sum + shape_factor(0) * n.x + shape_factor(1) * n.y + shape_factor(2) * n.z;
  sum = sum + shape_factor(3) * (n.x * n.y) + shape_factor(4) * (n.y * n.z) + shape_factor(5) * (n.z * n.x);
  sum = sum + shape_factor(6) * (n.x * n.x) + shape_factor(7) * (n.y * n.y) + shape_factor(8) * (n.z * n.z);
  // The truncated series can be negative for normals that face away from a light.
  return Vec3(max(sum.x, Real(0.0f)), max(sum.y, Real(0.0f)), max(sum.z, Real(0.0f)));
}
