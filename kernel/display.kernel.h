// Decodes display values, in the kernel dialect [IEC 61966-2-1]. The inverse, display_from_linear, is in
// common.kernel.h.

// Returns the linear value of an sRGB encoding; 0 where it is negative or NaN.
FN Real linear_from_display(Real v) {
  Real curve = pow(mad(max(v, Real(0.0f)), Real(1.0f / 1.055f), Real(0.055f / 1.055f)), Real(2.4f));
  return select(v > 0.04045f, curve, v * (1.0f / 12.92f));
}
FN Vec3 linear_from_display(Vec3 v) {
  return Vec3(linear_from_display(v.x), linear_from_display(v.y), linear_from_display(v.z));
}
