// Random and evenly spread numbers that depend on nothing but their arguments: a hash of integers, and the sequence of
// [Roberts 2018].
#pragma once
#include <cmath>
#include <cstdint>

namespace umbrage {

/// Returns a hash of two numbers.
inline std::uint32_t hash(std::uint32_t a, std::uint32_t b) {
  std::uint32_t v = a ^ (b * 0x9e3779b9u + 0x7f4a7c15u);
  v = (v ^ (v >> 16)) * 0x7feb352du;
  v = (v ^ (v >> 15)) * 0x846ca68bu;
  return v ^ (v >> 16);
}

/// Returns the number strictly between 0 and 1 that the upper bits of a hash represent.
inline float unit_real(std::uint32_t bits) {
  constexpr float kStep = 0x1p-23f;  // floats have 24 bits: 23 for the step, one for its centre
  return (float(bits >> 9) + 0.5f) * kStep;
}

/// The root of x^3 = x + 1. The fractional parts of k / kPlasticNumber and k / kPlasticNumber^2, for k = 1, 2, ..., are
/// evenly spread over the unit square.
inline constexpr double kPlasticNumber = 1.32471795724474602596;
inline double fractional_part(double v) { return v - std::floor(v); }

}  // namespace umbrage
