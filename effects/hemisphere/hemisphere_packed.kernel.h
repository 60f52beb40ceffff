// Packs what other pixels read from an emitter: its normal into one number, its light into two.
//
// A float holds two integers of 15 bits. kPackedExponent keeps its exponent away from the ends of the range, so that it
// is a normal number, which every machine loads and stores unchanged.
CONST int kPackedExponent = 0x20000000;
FN Real packed_pair(Uint high, Uint low) { return real_of_bits(to_uint(Int(kPackedExponent)) + ((high << 15) | low)); }
FN Real high_of_pair(Real pair) { return to_real(to_signed((bits_of(pair) - to_uint(Int(kPackedExponent))) >> 15)); }
FN Real low_of_pair(Real pair) { return to_real(to_signed(bits_of(pair) & Uint(0x7fffu))); }

// Normals are packed by the octahedral mapping of the sphere to a square [Cigolle et al. 2014]; error below 1e-4 rad.
CONST float kPackedHalf = 16383.0f;
FN Real with_sign(Real sign, Real v) { return select(sign < 0.0f, -v, v); }
FN Real packed_normal(Vec3 n) {
  Real scale = Real(1.0f) / max(abs(n.x) + abs(n.y) + abs(n.z), Real(1e-30f));
  Real x = n.x * scale;
  Real y = n.y * scale;
  Bool below = n.z < 0.0f;
  Real u = select(below, with_sign(x, 1.0f - abs(y)), x);
  Real v = select(below, with_sign(y, 1.0f - abs(x)), y);
  u = clamp(mad(u, Real(kPackedHalf), Real(kPackedHalf + 0.5f)), Real(0.0f), Real(2.0f * kPackedHalf));
  v = clamp(mad(v, Real(kPackedHalf), Real(kPackedHalf + 0.5f)), Real(0.0f), Real(2.0f * kPackedHalf));
  return packed_pair(to_uint(to_int(u)), to_uint(to_int(v)));
}
FN Vec3 unpacked_normal(Real pair) {
  Real x = mad(high_of_pair(pair), Real(1.0f / kPackedHalf), Real(-1.0f));
  Real y = mad(low_of_pair(pair), Real(1.0f / kPackedHalf), Real(-1.0f));
  Real z = 1.0f - abs(x) - abs(y);
  Real folded = max(-z, Real(0.0f));
  x = x - with_sign(x, folded);
  y = y - with_sign(y, folded);
  Real scale = rsqrt(mad(x, x, mad(y, y, z * z)));
  return Vec3(x * scale, y * scale, z * scale);
}

// Light, finite and not negative, is packed as the sum of its channels, and as the fractions of this sum that are in
// the first two; error below 1e-4 of the sum.
CONST float kPackedWhole = 16384.0f;
FN Real light_sum(Vec3 light) { return light.x + light.y + light.z; }
FN Real light_fractions(Vec3 light) {
  Real scale = Real(kPackedWhole) / max(light_sum(light), Real(1e-30f));
  Real first = min(mad(light.x, scale, Real(0.5f)), Real(kPackedWhole));
  Real second = min(mad(light.y, scale, Real(0.5f)), Real(kPackedWhole));
  return packed_pair(to_uint(to_int(first)), to_uint(to_int(second)));
}
FN Vec3 unpacked_light(Real sum, Real fractions) {
  Real scale = sum * (1.0f / kPackedWhole);
  Real first = high_of_pair(fractions) * scale;
  Real second = low_of_pair(fractions) * scale;
  return Vec3(first, second, max(sum - first - second, Real(0.0f)));
}
