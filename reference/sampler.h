// Sampler: points of the unit square at which a pixel's integrals are evaluated. Sobol' points with nested uniform
// scrambling, by hashing [Owen 1997, Burley 2020]: any number of them is evenly distributed, every power of two of them
// is stratified in all elementary boxes, and the points of different pixels are independent.
#pragma once
#include <bit>
#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "core/hash.h"

namespace umbrage {

/// Reverses the bits of a number.
inline std::uint32_t reversed(std::uint32_t v) {
  v = (v >> 16) | (v << 16);
  v = ((v & 0x00ff00ffu) << 8) | ((v & 0xff00ff00u) >> 8);
  v = ((v & 0x0f0f0f0fu) << 4) | ((v & 0xf0f0f0f0u) >> 4);
  v = ((v & 0x33333333u) << 2) | ((v & 0xccccccccu) >> 2);
  return ((v & 0x55555555u) << 1) | ((v & 0xaaaaaaaau) >> 1);
}

/// Permutes 32-bit numbers such that each bit of the result depends only on the same and lower bits [Laine and Karras
/// 2011], with the constants of [Vegdahl 2021].
inline std::uint32_t scrambled_low_to_high(std::uint32_t v, std::uint32_t seed) {
  v ^= v * 0x3d20adeau;
  v += seed;
  v *= (seed >> 16) | 1u;
  v ^= v * 0x05526c56u;
  v ^= v * 0x53a22864u;
  return v;
}

/// Two Sobol' coordinates of the first points, up to the next power of two of the requested count. The bits are
/// reversed for scrambling.
struct SampleTable {
  std::vector<std::uint32_t> first, second;
};

inline SampleTable sample_table(int count) {
  SampleTable table;
  for (std::uint32_t i = 0; i < std::bit_ceil(std::uint32_t(count)); ++i) {
    table.first.push_back(i);  // the first coordinate is i with its bits reversed
    std::uint32_t second = 0;
    for (std::uint32_t bits = i, row = 0x80000000u; bits != 0; bits >>= 1, row ^= row >> 1)
      if (bits & 1u) second ^= row;
    table.second.push_back(reversed(second));
  }
  return table;
}

/// Returns point i of the set `seed`, strictly inside the unit square.
inline glm::vec2 sample_point(const SampleTable& table, int i, std::uint32_t seed) {
  const std::uint32_t x = reversed(scrambled_low_to_high(table.first[i], hash(seed, 1u)));
  const std::uint32_t y = reversed(scrambled_low_to_high(table.second[i], hash(seed, 2u)));
  return {unit_real(x), unit_real(y)};
}

/// Returns the index of the i-th point in a permuted order that maps aligned runs of a power of two to such runs
/// [Burley 2020]. If one ray uses points of two sets, one set must be shuffled. With scrambling alone, the points
/// of both sets would always lie in corresponding halves, quarters and so on, and their integral would not converge.
inline int shuffled(const SampleTable& table, int i, std::uint32_t seed) {
  const std::uint32_t mixed = reversed(scrambled_low_to_high(reversed(std::uint32_t(i)), hash(seed, 3u)));
  return int(mixed & std::uint32_t(table.first.size() - 1));
}

}  // namespace umbrage
