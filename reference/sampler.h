// Sampler: the points of the unit square at which a pixel's integrals are evaluated. Sobol' points with nested uniform
// scrambling, by hash [Owen 1997, Burley 2020]: any number of them is spread evenly, every power of two of them is
// stratified in all elementary boxes, and each pixel's are independent of every other's.
#pragma once
#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

namespace umbrage {

/// A random 32-bit number from two.
inline std::uint32_t hash(std::uint32_t a, std::uint32_t b) {
  std::uint32_t v = a ^ (b * 0x9e3779b9u + 0x7f4a7c15u);
  v = (v ^ (v >> 16)) * 0x7feb352du;
  v = (v ^ (v >> 15)) * 0x846ca68bu;
  return v ^ (v >> 16);
}

inline std::uint32_t reversed(std::uint32_t v) {
  v = (v >> 16) | (v << 16);
  v = ((v & 0x00ff00ffu) << 8) | ((v & 0xff00ff00u) >> 8);
  v = ((v & 0x0f0f0f0fu) << 4) | ((v & 0xf0f0f0f0u) >> 4);
  v = ((v & 0x33333333u) << 2) | ((v & 0xccccccccu) >> 2);
  return ((v & 0x55555555u) << 1) | ((v & 0xaaaaaaaau) >> 1);
}

/// Permutes numbers so that a bit depends on itself and lower bits alone [Laine and Karras 2011], with the constants of
/// [Vegdahl 2021].
inline std::uint32_t scrambled_low_to_high(std::uint32_t v, std::uint32_t seed) {
  v ^= v * 0x3d20adeau;
  v += seed;
  v *= (seed >> 16) | 1u;
  v ^= v * 0x05526c56u;
  v ^= v * 0x53a22864u;
  return v;
}

/// Two Sobol' coordinates of the points 0 to count - 1, their bits reversed for scrambling.
struct SampleTable {
  std::vector<std::uint32_t> first, second;
};

inline SampleTable sample_table(int count) {
  SampleTable table;
  for (std::uint32_t i = 0; i < std::uint32_t(count); ++i) {
    table.first.push_back(i);  // the first coordinate is i with its bits reversed
    std::uint32_t second = 0;
    for (std::uint32_t bits = i, row = 0x80000000u; bits != 0; bits >>= 1, row ^= row >> 1)
      if (bits & 1u) second ^= row;
    table.second.push_back(reversed(second));
  }
  return table;
}

/// Point i of the set that `seed` names, in [0, 1) squared.
inline glm::vec2 sample_point(const SampleTable& table, int i, std::uint32_t seed) {
  constexpr float kStep = 0x1p-24f;  // floats hold 24 bits: 1 itself is never reached
  const std::uint32_t x = reversed(scrambled_low_to_high(table.first[i], hash(seed, 1u)));
  const std::uint32_t y = reversed(scrambled_low_to_high(table.second[i], hash(seed, 2u)));
  return {float(x >> 8) * kStep, float(y >> 8) * kStep};
}

}  // namespace umbrage
