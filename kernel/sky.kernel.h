// Ambient light from a direction d: a constant plus L(d) = l.d + d'Qd, spherical harmonics up to the second degree.
// C.sky holds l and Q for red, green and blue, as sky_factors() in core/light.h returns them: nine each.

// Returns the sum of Q's diagonal times `squares` and of its xy, yz and zx times `products`, for a colour channel.
FN Real sky_quadratic_of(int channel, Vec3 squares, Vec3 products) {
  int k = 9 * channel + 3;
  return dot(Vec3(Real(C.sky[k]), Real(C.sky[k + 1]), Real(C.sky[k + 2])), squares) +
         dot(Vec3(Real(C.sky[k + 3]), Real(C.sky[k + 4]), Real(C.sky[k + 5])), products);
}

// Returns a'Qb for a colour channel.
FN Real sky_quadratic(int channel, Vec3 a, Vec3 b) {
  Vec3 products = Vec3(mad(a.x, b.y, a.y * b.x), mad(a.y, b.z, a.z * b.y), mad(a.z, b.x, a.x * b.z));
  return sky_quadratic_of(channel, Vec3(a.x * b.x, a.y * b.y, a.z * b.z), products);
}

// Returns l.a for a colour channel.
FN Real sky_linear(int channel, Vec3 a) {
  int k = 9 * channel;
  return dot(Vec3(Real(C.sky[k]), Real(C.sky[k + 1]), Real(C.sky[k + 2])), a);
}
