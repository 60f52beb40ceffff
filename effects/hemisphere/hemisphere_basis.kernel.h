// The basis of a pixel's sample points, whose third vector is the normal, and the noise that rotates it about the
// normal. Based on [Colliander and Törnquist 2015], "The Noise Texture" and "SSAO Pass".

#include "kernel/angles.kernel.h"

// Returns the remainder of a pixel coordinate, divided by the side of the noise tile.
FN Int in_tile(Int x) {
  // 0.5 is half a pixel from every border between tiles, so that rounding does not matter.
  Real tiles = floor((to_real(x) + 0.5f) * Real(C.one_over_noise));
  return x - to_int(tiles) * Int(C.noise);
}

// Returns the noise of a pixel: x and y, the cosine and sine of the angle by which its sample points are rotated about
// the normal; z in [0, 1), the shift of their lengths as a fraction of the range. The noise repeats from tile to tile.
FN Vec3 noise_at(Int px, Int py) {
  Uint seed = scrambled(Uint(0x9e3779b9u) + to_uint(Int(C.seed)));
  Int x = px;
  Int y = py;
  if (C.noise > 0) {
    x = in_tile(px);
    y = in_tile(py);
  }
  // Angles and lengths within a tile are points of the golden ratio's two-dimensional sequence [Roberts 2018].
  Uint index = to_uint(y * Int(C.noise) + x);
  Uint first = index * Uint(0xc13fa9a9u) + seed;
  Uint second = index * Uint(0x91e10da6u) + seed * Uint(3u);
  if (C.even == 0 || C.noise == 0) {
    first = scrambled(to_uint(x) ^ scrambled(to_uint(y) + seed));
    second = scrambled(first + Uint(1u));
  }
  if (C.even == 0) {
    // The paper's noise texture: a vector with x and y uniform in [-1, 1], scaled to length 1.
    Real a = mad(unit_real(first), Real(2.0f), Real(-1.0f + 5.9604645e-8f));  // never 0: half a step off
    Real b = mad(unit_real(second), Real(2.0f), Real(-1.0f));
    Real scale = Real(1.0f) / sqrt(mad(a, a, b * b));
    return Vec3(a * scale, b * scale, Real(0.0f));
  }
  // The rotation is by `quarter` + `rest` quarter turns, with `rest` in [-0.5, 0.5).
  Real turn = unit_real(first) * 4.0f;
  Real quarter = floor(turn);
  Real rest = turn - quarter - 0.5f;
  Real s = sine_of_quarter_turns(rest);
  Real c = sqrt(max(mad(-s, s, Real(1.0f)), Real(0.0f)));
  Real turn_cos = select(quarter == 1.0f || quarter == 3.0f, s, c);
  Real turn_sin = select(quarter == 1.0f || quarter == 3.0f, c, s);
  turn_cos = select(quarter == 1.0f || quarter == 2.0f, -turn_cos, turn_cos);
  turn_sin = select(quarter == 2.0f || quarter == 3.0f, -turn_sin, turn_sin);
  return Vec3(turn_cos, turn_sin, unit_real(second));
}

// Returns the first vector of the basis, of unit length: the cross product of a fixed vector and the normal, rotated
// about the normal by the noise. Where the fixed vector is parallel to the normal, another one is used.
FN Vec3 rotated_tangent(Vec3 normal, Vec3 noise) {
  Bool parallel = abs(normal.y) > 0.99f;
  Vec3 fixed_vector =
      Vec3(select(parallel, Real(1.0f), Real(0.0f)), select(parallel, Real(0.0f), Real(1.0f)), Real(0.0f));
  Vec3 tangent = cross(fixed_vector, normal);
  tangent = tangent * (Real(1.0f) / sqrt(max(dot(tangent, tangent), Real(1e-30f))));
  return tangent * noise.x + cross(normal, tangent) * noise.y;
}
