// The kernel dialect as plain C++, one pixel at a time. This file defines the dialect; lanes.h and glsl.h implement the
// same operations.
#pragma once
#include <bit>
#include <cmath>
#include <cstdint>

namespace umbrage::scalar {

using Real = float;
using Int = std::int32_t;
using Uint = std::uint32_t;
using Bool = bool;
constexpr int kLanes = 1;
/// Max length, in numbers per pixel, at which lists are efficient on this target.
constexpr int kListLength = 8;

inline Real min(Real a, Real b) { return a < b ? a : b; }
inline Real max(Real a, Real b) { return a > b ? a : b; }
inline Int min(Int a, Int b) { return a < b ? a : b; }
inline Int max(Int a, Int b) { return a > b ? a : b; }
inline Real clamp(Real x, Real min_value, Real max_value) { return min(max(x, min_value), max_value); }
inline Int clamp(Int x, Int min_value, Int max_value) { return min(max(x, min_value), max_value); }
inline Real abs(Real a) { return std::fabs(a); }
inline Real floor(Real a) { return std::floor(a); }
inline Real fract(Real a) { return a - std::floor(a); }
inline Real sqrt(Real a) { return std::sqrt(a); }
inline Real rsqrt(Real a) { return 1.0f / std::sqrt(a); }
/// Returns a^b for a > 0; 0 for a <= 0.
inline Real pow(Real a, Real b) { return a > 0.0f ? std::pow(a, b) : 0.0f; }
/// Returns a b + c, rounded once. SSE4 may differ in the last bit (lanes.h).
inline Real mad(Real a, Real b, Real c) { return std::fma(a, b, c); }
/// Rounds towards zero. The result must fit into an Int.
inline Int to_int(Real a) { return Int(a); }
inline Uint to_uint(Int a) { return Uint(a); }
inline Int to_signed(Uint a) { return Int(a); }
/// Rounds to the nearest float, ties to even.
inline Real to_real(Int a) { return Real(a); }
inline Real to_real(Uint a) { return Real(a); }
inline Uint bits_of(Real a) { return std::bit_cast<Uint>(a); }
/// Returns the number with these bits. It should be normal: hardware may turn others into 0 or another NaN.
inline Real real_of_bits(Uint a) { return std::bit_cast<Real>(a); }
inline Int popcount(Uint a) { return __builtin_popcount(a); }
/// Returns a word in which bit b and all higher bits are set (none for b = 32); b in [0, 32].
inline Uint ones_from(Int b) { return b < 32 ? 0xffffffffu << b : 0u; }
inline bool is_finite(Real a) { return std::fabs(a) <= 3.402823466e38f; }
/// Returns whether the mask is set in any lane. The lanes are the pixels that are computed at the same time.
inline bool some(Bool a) { return a; }
/// Returns the number of lanes in which the mask is set.
inline int count_lanes(Bool a) { return a ? 1 : 0; }
/// Returns the index of this pixel's lane, 0 to kLanes - 1.
inline Int this_lane() { return 0; }
/// Returns the value v of the lane with that index.
inline Real lane_value(Real v, Int) { return v; }

/// Returns an element of an array of constants.
template <class T>
inline T entry_of(const T* array, Int k) {
  return array[k];
}

struct Vec2 {
  Real x, y;
};
struct Vec3 {
  Real x, y, z;
};

template <class T>
inline T select(Bool mask, T a, T b) {
  return mask ? a : b;
}

#include "kernel/vectors.h"

/// Moves the values of lanes whose mask is set to the first lanes, in order; the remaining lanes are undefined.
template <class T>
inline T packed(Bool, T v) {
  return v;
}
/// A sum per lane.
struct LaneSums {
  Vec3 sum;
};
inline void clear(LaneSums& s) { s.sum = Vec3{0.0f, 0.0f, 0.0f}; }
/// Adds each lane's v to the sum of lane `lane`, in the order of the lanes.
inline void add_to_lanes(LaneSums& s, Int, Vec3 v) { s.sum = s.sum + v; }
inline Vec3 sums_of(const LaneSums& s) { return s.sum; }

}  // namespace umbrage::scalar
