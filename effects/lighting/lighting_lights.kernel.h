// Computes the direction and falloff of the lights of LightingConstants at a view-space position.

// Returns the squared length of the vector to a point light; > 0.
FN Real squared_distance(Vec3 to_light) { return max(dot(to_light, to_light), Real(1e-20f)); }

// Returns the unit vector from a view-space position towards light k.
FN Vec3 towards_light(int k, Vec3 position) {
  Vec3 light = Vec3(Real(C.x[k]), Real(C.y[k]), Real(C.z[k]));
  if (C.kind[k] != 1) return light;
  Vec3 to_light = light - position;
  return to_light * rsqrt(squared_distance(to_light));
}

// Returns the sine of the angular radius of light k, as seen from a position.
FN Real light_sine(int k, Vec3 position) {
  if (C.kind[k] != 1) return Real(C.size[k]);
  Vec3 to_light = Vec3(Real(C.x[k]), Real(C.y[k]), Real(C.z[k])) - position;
  return min(Real(C.size[k]) * rsqrt(squared_distance(to_light)), Real(1.0f));
}

// Returns the factor of the colour of light k at an unoccluded position, by its distance; may exceed 1.
FN Real light_falloff(int k, Vec3 position) {
  if (C.kind[k] != 1 || !(C.reach_squared[k] > 0.0f)) return Real(1.0f);
  return Real(C.reach_squared[k]) / squared_distance(Vec3(Real(C.x[k]), Real(C.y[k]), Real(C.z[k])) - position);
}
