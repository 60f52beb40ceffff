// Light as `output` takes it, shared by its dispatches.

FN Vec3 clamped_to_0(Vec3 v) { return Vec3(max(v.x, Real(0.0f)), max(v.y, Real(0.0f)), max(v.z, Real(0.0f))); }

// Returns light that is finite and not negative: NaN and infinity become black.
FN Vec3 light_of(Vec3 light) { return clamped_to_0(finite_or_zero(light)); }
