// Compares the operations of the kernel dialect on every SIMD target with scalar.h, which defines them.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "kernel/isa.h"
#include "kernel/scalar.h"
#include "support.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernel/dialect_test.cpp"
#include "hwy/foreach_target.h"

#include "kernel/lanes.h"

#ifndef UMBRAGE_DIALECT_TEST_RESULTS
#define UMBRAGE_DIALECT_TEST_RESULTS
struct DialectInput {
  std::vector<unsigned> bits;  // their number is a multiple of 16
  std::vector<float> reals;    // positive, as many as bits
};
struct DialectResults {
  std::vector<int> popcount, to_int;
  std::vector<unsigned> ones_from, shifted;
  std::vector<float> real_of_uint, real_of_int, mad, rsqrt, pow, floor, fract;
  std::vector<int> less;
  // Results of operations across lanes.
  int lanes = 0;
  std::vector<int> count_lanes, this_lane;
  std::vector<float> packed, lane_value, added[3];
  std::vector<unsigned> packed_bits, bits_of;
};
#endif

HWY_BEFORE_NAMESPACE();
namespace umbrage {
namespace HWY_NAMESPACE {
namespace {

void RunDialect(const DialectInput& in, DialectResults& out) {
  out.lanes = kLanes;
  const D d;
  const DI di;
  const DU du;
  for (std::size_t i = 0; i < in.bits.size(); i += kLanes) {
    const Uint bits = hn::LoadU(du, in.bits.data() + i);
    const Real real = hn::LoadU(d, in.reals.data() + i);
    const Int count = to_signed(bits & Uint(31u)) + Int(1);  // 1 to 32
    hn::StoreU(popcount(bits).v, di, out.popcount.data() + i);
    hn::StoreU(ones_from(count).v, du, out.ones_from.data() + i);
    hn::StoreU(((bits << 3) ^ (bits >> 5)).v, du, out.shifted.data() + i);
    hn::StoreU(to_real(bits).v, d, out.real_of_uint.data() + i);
    hn::StoreU(to_real(to_signed(bits)).v, d, out.real_of_int.data() + i);
    hn::StoreU(to_int(real * Real(1000.0f)).v, di, out.to_int.data() + i);
    hn::StoreU(mad(real, real, Real(-0.5f)).v, d, out.mad.data() + i);
    hn::StoreU(rsqrt(real).v, d, out.rsqrt.data() + i);
    hn::StoreU(pow(real, Real(2.4f)).v, d, out.pow.data() + i);
    hn::StoreU(floor(real - Real(3.0f)).v, d, out.floor.data() + i);
    hn::StoreU(fract(real - Real(3.0f)).v, d, out.fract.data() + i);
    hn::StoreU(select(bits < Uint(0x80000001u), Int(1), Int(0)).v, di, out.less.data() + i);
    const Bool odd = to_signed(bits & Uint(1u)) == Int(1);
    const Int lane = to_signed((bits >> 9) & Uint(unsigned(kLanes - 1)));
    hn::StoreU(Int(count_lanes(odd)).v, di, out.count_lanes.data() + i);
    hn::StoreU(this_lane().v, di, out.this_lane.data() + i);
    hn::StoreU(packed(odd, real).v, d, out.packed.data() + i);
    hn::StoreU(packed(odd, bits).v, du, out.packed_bits.data() + i);
    hn::StoreU(lane_value(real, lane).v, d, out.lane_value.data() + i);
    LaneSums sums;
    clear(sums);
    add_to_lanes(sums, this_lane(), Vec3{real * Real(5.0f), real * Real(7.0f), real});
    add_to_lanes(sums, lane, Vec3{real, real * Real(2.0f), real * Real(3.0f)});
    const Vec3 added = sums_of(sums);
    hn::StoreU(added.x.v, d, out.added[0].data() + i);
    hn::StoreU(added.y.v, d, out.added[1].data() + i);
    hn::StoreU(added.z.v, d, out.added[2].data() + i);
    hn::StoreU(bits_of(real_of_bits(bits_of(real))).v, du, out.bits_of.data() + i);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace umbrage
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace umbrage {
namespace {

HWY_EXPORT(RunDialect);

/// Checks the operations across lanes, for the vector that starts at `first`.
void expect_lanes_together(const DialectInput& in, const DialectResults& out, std::size_t first,
                           const std::string& target) {
  std::vector<float> odd, sums[3];
  std::vector<unsigned> odd_bits;
  for (int lane = 0; lane < out.lanes; ++lane) {
    const std::size_t i = first + std::size_t(lane);
    sums[0].push_back(in.reals[i] * 5.0f);
    sums[1].push_back(in.reals[i] * 7.0f);
    sums[2].push_back(in.reals[i]);
    if (in.bits[i] % 2 == 0) continue;
    odd.push_back(in.reals[i]);
    odd_bits.push_back(in.bits[i]);
  }
  for (int lane = 0; lane < out.lanes; ++lane) {
    const std::size_t i = first + std::size_t(lane);
    const unsigned other = in.bits[i] >> 9 & unsigned(out.lanes - 1);
    ASSERT_EQ(out.this_lane[i], lane) << target;
    ASSERT_EQ(out.count_lanes[i], int(odd.size())) << target;
    ASSERT_EQ(out.lane_value[i], in.reals[first + other]) << target;
    for (int channel = 0; channel < 3; ++channel) sums[channel][other] += in.reals[i] * float(channel + 1);
  }
  for (std::size_t k = 0; k < odd.size(); ++k) {
    ASSERT_EQ(out.packed[first + k], odd[k]) << target;
    ASSERT_EQ(out.packed_bits[first + k], odd_bits[k]) << target;
  }
  for (int channel = 0; channel < 3; ++channel)
    for (std::size_t k = 0; k < sums[channel].size(); ++k)
      ASSERT_EQ(out.added[channel][first + k], sums[channel][k]) << target;
}

TEST(Dialect, LanesMeanWhatScalarMeans) {
  DialectInput in;
  unsigned random = 12345u;
  for (int i = 0; i < 4096; ++i) {
    random = random * 1664525u + 1013904223u;
    in.bits.push_back(i == 0 ? 0u : i == 1 ? ~0u : i == 2 ? 31u : random);
    in.reals.push_back(i == 0 ? 1.0f : std::exp2(float(random >> 8) * 0x1p-24f * 20.0f - 10.0f));
  }
  const std::size_t n = in.bits.size();
  for (const std::string_view target : test::isas()) {
    ASSERT_TRUE(choose_isa(target));
    DialectResults out{std::vector<int>(n),
                       std::vector<int>(n),
                       std::vector<unsigned>(n),
                       std::vector<unsigned>(n),
                       std::vector<float>(n),
                       std::vector<float>(n),
                       std::vector<float>(n),
                       std::vector<float>(n),
                       std::vector<float>(n),
                       std::vector<float>(n),
                       std::vector<float>(n),
                       std::vector<int>(n),
                       0,
                       std::vector<int>(n),
                       std::vector<int>(n),
                       std::vector<float>(n),
                       std::vector<float>(n),
                       {std::vector<float>(n), std::vector<float>(n), std::vector<float>(n)},
                       std::vector<unsigned>(n),
                       std::vector<unsigned>(n)};
    HWY_DYNAMIC_DISPATCH(RunDialect)(in, out);
    EXPECT_EQ(out.rsqrt[0], 1.0f) << target;  // unit normals keep length 1
    for (std::size_t i = 0; i < n; ++i) {
      const unsigned bits = in.bits[i];
      const float real = in.reals[i];
      ASSERT_EQ(out.popcount[i], scalar::popcount(bits)) << target;
      ASSERT_EQ(out.ones_from[i], scalar::ones_from(int(bits & 31u) + 1)) << target;
      ASSERT_EQ(out.shifted[i], (bits << 3) ^ (bits >> 5)) << target;
      ASSERT_EQ(out.real_of_uint[i], scalar::to_real(bits)) << target << ' ' << bits;
      ASSERT_EQ(out.real_of_int[i], scalar::to_real(scalar::to_signed(bits))) << target;
      ASSERT_EQ(out.to_int[i], scalar::to_int(real * 1000.0f)) << target;
      // SSE4 has no fused multiply-add: the last bit may differ.
      ASSERT_NEAR(out.mad[i], scalar::mad(real, real, -0.5f), 1.2e-7f * std::fabs(real * real)) << target;
      ASSERT_NEAR(out.rsqrt[i] / scalar::rsqrt(real), 1.0f, 2.5e-7f) << target;
      ASSERT_NEAR(out.pow[i] / scalar::pow(real, 2.4f), 1.0f, 1e-5f) << target;
      ASSERT_EQ(out.floor[i], scalar::floor(real - 3.0f)) << target;
      ASSERT_EQ(out.fract[i], scalar::fract(real - 3.0f)) << target;
      ASSERT_EQ(out.less[i], bits < 0x80000001u ? 1 : 0) << target;
      ASSERT_EQ(out.bits_of[i], scalar::bits_of(real)) << target;
    }
    for (std::size_t first = 0; first < n; first += std::size_t(out.lanes))
      expect_lanes_together(in, out, first, std::string(target));
  }
  choose_isa("");
}

TEST(Dialect, InstructionSetsOfThisMachineAreKnown) {
  EXPECT_EQ(usable_isas().back(), "scalar");
  EXPECT_FALSE(choose_isa("avx99"));
  EXPECT_EQ(isa_in_use(), test::isas().front());
  ASSERT_TRUE(choose_isa("scalar"));
  EXPECT_EQ(isa_in_use(), "scalar");
  ASSERT_TRUE(choose_isa(""));
  EXPECT_EQ(isa_in_use(), test::isas().front());
}

}  // namespace
}  // namespace umbrage
#endif
