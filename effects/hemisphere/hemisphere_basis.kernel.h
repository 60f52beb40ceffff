// The basis about a pixel's normal in which its sample points lie, and the noise that rotates it. Based on [Colliander
// and Törnquist 2015], "The Noise Texture" and "SSAO Pass".

#include "kernel/angles.kernel.h"

// Returns the remainder of a pixel coordinate divided by the tile's side.
FN Int in_tile(Int x) {
  Real tiles = floor((to_real(x) + 0.5f) * Real(C.one_over_noise));  // half a pixel off every border: rounding is safe
  return x - to_int(tiles) * Int(C.noise);
}

// Returns the noise of a pixel: cosine and sine (x, y) of the rotation of its sample points about the normal; and z in
// [0, 1), the shift of their lengths as a fraction of the range. The tile repeats.
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
    // The paper's noise texture: x and y uniform in [-1, 1], then scaled to length 1.
    Real a = mad(share_of_one(first), Real(2.0f), Real(-1.0f + 5.9604645e-8f));  // half a step away from 0
    Real b = mad(share_of_one(second), Real(2.0f), Real(-1.0f));
    Real scale = Real(1.0f) / sqrt(mad(a, a, b * b));
    return Vec3(a * scale, b * scale, Real(0.0f));
  }
  // The rotation in quarter turns: the quarter's centre plus up to an eighth of a turn to either side.
  Real turn = share_of_one(first) * 4.0f;
  Real quarter = floor(turn);
  Real rest = turn - quarter - 0.5f;
  Real s = sine_of_quarter_turns(rest);
  Real c = sqrt(max(mad(-s, s, Real(1.0f)), Real(0.0f)));
  Real across = select(quarter == 1.0f || quarter == 3.0f, s, c);
  Real along = select(quarter == 1.0f || quarter == 3.0f, c, s);
  across = select(quarter == 1.0f || quarter == 2.0f, -across, across);
  along = select(quarter == 2.0f || quarter == 3.0f, -along, along);
  return Vec3(across, along, share_of_one(second));
}

// Returns the first vector of the basis, of unit length: a fixed vector (another one where it is parallel to the
// normal) made perpendicular to the normal and rotated about it by the noise.
FN Vec3 turned_tangent(Vec3 normal, Vec3 noise) {
  Bool parallel = abs(normal.y) > 0.99f;
  Vec3 fixed_vector =
      Vec3(select(parallel, Real(1.0f), Real(0.0f)), select(parallel, Real(0.0f), Real(1.0f)), Real(0.0f));
  Vec3 tangent = cross(fixed_vector, normal);
  tangent = tangent * (Real(1.0f) / sqrt(max(dot(tangent, tangent), Real(1e-30f))));
  return tangent * noise.x + cross(normal, tangent) * noise.y;
}
