// Three noise values per pixel, each in [0, 1): x rotates the slices, as a fraction of the angle between two slices; y
// shifts the steps along a slice, in steps; z shifts the borders between bits, in bits.
#include "kernel/angles.kernel.h"

// Returns the index of a pixel along a Hilbert curve through 64 x 64 pixels. Pixels with adjacent indices are adjacent.
FN Uint hilbert_index(Uint x, Uint y) {
  Uint index = Uint(0u);
  for (int level = 5; level >= 0; --level) {
    Uint x_bit = (x >> level) & Uint(1u);
    Uint y_bit = (y >> level) & Uint(1u);
    index = (index << 2) | ((x_bit * Uint(3u)) ^ y_bit);
    // In a sub-square, the curve is mirrored if x_bit = 1 and y_bit = 0; x and y are swapped if y_bit = 0.
    Uint mirrored = x_bit & (y_bit ^ Uint(1u));
    Uint mirror_mask = Uint(0u) - mirrored;
    Uint swap_mask = Uint(0u) - (y_bit ^ Uint(1u));
    x = x ^ mirror_mask;
    y = y ^ mirror_mask;
    Uint difference = (x ^ y) & swap_mask;
    x = x ^ difference;
    y = y ^ difference;
  }
  return index;
}

// Returns the noise values of a pixel for the picture's sample index.
FN Vec3 noise_at(Int px, Int py) {
  Vec3 noise = Vec3(Real(0.5f), Real(0.5f), Real(0.5f));
  if (C.noise == kBitmaskHilbert || C.noise == kBitmaskHash) {
    // The golden-ratio sequence in three dimensions [Roberts 2018] along the curve gives neighbours different values.
    Uint index = hilbert_index(to_uint(px) & Uint(63u), to_uint(py) & Uint(63u));
    Uint first = index * Uint(0xd1b54a33u);
    Uint second = index * Uint(0xabc98389u);
    Uint third = index * Uint(0x8cb92ba7u);
    if (C.noise == kBitmaskHash) {
      first = scrambled(to_uint(px) ^ scrambled(to_uint(py) + Uint(0x9e3779b9u)));
      second = scrambled(first + Uint(1u));
      third = scrambled(first + Uint(2u));
    }
    noise = Vec3(unit_real(first), unit_real(second), unit_real(third));
  }
  if (C.noise == kBitmaskTile) {
    // 4 x 4 pixels have sixteen rotations and sixteen offsets; a filter of this width removes the noise entirely.
    Uint x = to_uint(px) & Uint(3u);
    Uint y = to_uint(py) & Uint(3u);
    Uint turn = (((x + y) & Uint(3u)) << 2) + x;
    Uint steps = (((y - x) & Uint(3u)) << 2) + (((x >> 1) + (y << 1)) & Uint(3u));
    noise = Vec3(to_real(to_signed(turn)) * 0.0625f, to_real(to_signed(steps)) * 0.0625f,
                 to_real(to_signed((turn * Uint(7u)) & Uint(15u))) * 0.0625f);
    noise = noise + Vec3(Real(0.03125f), Real(0.03125f), Real(0.03125f));
  }
  return Vec3(fract(noise.x + Real(C.sample_turn)), fract(noise.y + Real(C.sample_step)),
              fract(noise.z + Real(C.sample_bit)));
}
