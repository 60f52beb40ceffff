// Random numbers and trigonometric functions in the kernel dialect, which round identically on every machine. Kernels
// that need them include this file.

// Converts random bits to a number in [0, 1).
FN Real unit_real(Uint v) { return to_real(v >> 8) * 5.9604645e-8f; }  // 2^-24

// Returns the sine of u quarter turns, u in [-0.5, 0.5], from a truncated series; error below 1e-6.
FN Real sine_of_quarter_turns(Real u) {
  Real x = u * 1.57079633f;
  Real squared = x * x;
  Real sum = mad(squared, Real(2.7557319e-6f), Real(-1.9841270e-4f));
  sum = mad(sum, squared, Real(8.3333333e-3f));
  sum = mad(sum, squared, Real(-0.16666667f));
  return mad(sum * squared, x, x);
}

// Returns (cosine, sine) of an angle, given as a fraction of a full turn in [0, 1).
FN Vec2 direction_of_turn(Real turn) {
  Real s = sine_of_quarter_turns(turn - 0.5f);
  Real c = sqrt(mad(-s, s, Real(1.0f)));
  Real half_s = 2.0f * s * c;
  Real half_c = mad(s * s, Real(-2.0f), Real(1.0f));
  return Vec2(mad(half_s * half_s, Real(-2.0f), Real(1.0f)), 2.0f * half_s * half_c);
}
