// The kernel dialect in SIMD with Highway: one pixel per lane, usually consecutive pixels of a row. Included once per
// SIMD target, after hwy/foreach_target.h. The structs around Highway's vectors require vectors of fixed size: they
// work on x86 and NEON but not on SVE or RVV.
#if defined(UMBRAGE_MACHINE_LANES_H) == defined(HWY_TARGET_TOGGLE)
#ifdef UMBRAGE_MACHINE_LANES_H
#undef UMBRAGE_MACHINE_LANES_H
#else
#define UMBRAGE_MACHINE_LANES_H
#endif

#include <cstdint>

#include "hwy/contrib/math/math-inl.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace umbrage {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using DI = hn::RebindToSigned<D>;
using DU = hn::RebindToUnsigned<D>;
constexpr int kLanes = int(hn::MaxLanes(D()));
constexpr int kListLength = 16;

#define OP HWY_INLINE HWY_MAYBE_UNUSED

struct Bool {
  hn::Mask<D> m;
  HWY_INLINE Bool(hn::Mask<D> x) : m(x) {}
  HWY_INLINE explicit Bool(bool x) : m(hn::FirstN(D(), x ? hn::Lanes(D()) : 0)) {}
};
struct Int {
  hn::Vec<DI> v;
  HWY_INLINE Int(hn::Vec<DI> x) : v(x) {}
  HWY_INLINE Int(int x) : v(hn::Set(DI(), x)) {}
};
struct Uint {
  hn::Vec<DU> v;
  HWY_INLINE Uint(hn::Vec<DU> x) : v(x) {}
  HWY_INLINE Uint(std::uint32_t x) : v(hn::Set(DU(), x)) {}
};
struct Real {
  hn::Vec<D> v;
  HWY_INLINE Real(hn::Vec<D> x) : v(x) {}
  HWY_INLINE Real(float x) : v(hn::Set(D(), x)) {}
};
struct Vec2 {
  Real x, y;
};
struct Vec3 {
  Real x, y, z;
};

OP Real operator+(Real a, Real b) { return hn::Add(a.v, b.v); }
OP Real operator-(Real a, Real b) { return hn::Sub(a.v, b.v); }
OP Real operator*(Real a, Real b) { return hn::Mul(a.v, b.v); }
OP Real operator/(Real a, Real b) { return hn::Div(a.v, b.v); }
OP Real operator-(Real a) { return hn::Neg(a.v); }
OP Int operator+(Int a, Int b) { return hn::Add(a.v, b.v); }
OP Int operator-(Int a, Int b) { return hn::Sub(a.v, b.v); }
OP Int operator*(Int a, Int b) { return hn::Mul(a.v, b.v); }
OP Int operator-(Int a) { return hn::Neg(a.v); }
OP Uint operator+(Uint a, Uint b) { return hn::Add(a.v, b.v); }
OP Uint operator-(Uint a, Uint b) { return hn::Sub(a.v, b.v); }
OP Uint operator*(Uint a, Uint b) { return hn::Mul(a.v, b.v); }
OP Uint operator|(Uint a, Uint b) { return hn::Or(a.v, b.v); }
OP Uint operator&(Uint a, Uint b) { return hn::And(a.v, b.v); }
OP Uint operator^(Uint a, Uint b) { return hn::Xor(a.v, b.v); }
OP Uint operator~(Uint a) { return hn::Not(a.v); }
OP Uint operator<<(Uint a, int bits) { return hn::ShiftLeftSame(a.v, bits); }
OP Uint operator>>(Uint a, int bits) { return hn::ShiftRightSame(a.v, bits); }
template <class A, class B>
OP A& operator+=(A& a, B b) {
  a = a + b;
  return a;
}
template <class A, class B>
OP A& operator-=(A& a, B b) {
  a = a - b;
  return a;
}
template <class A, class B>
OP A& operator*=(A& a, B b) {
  a = a * b;
  return a;
}
OP Uint& operator|=(Uint& a, Uint b) { return a = a | b; }

OP Bool operator<(Real a, Real b) { return {hn::Lt(a.v, b.v)}; }
OP Bool operator<=(Real a, Real b) { return {hn::Le(a.v, b.v)}; }
OP Bool operator>(Real a, Real b) { return {hn::Lt(b.v, a.v)}; }
OP Bool operator>=(Real a, Real b) { return {hn::Le(b.v, a.v)}; }
OP Bool operator==(Real a, Real b) { return {hn::Eq(a.v, b.v)}; }
OP Bool operator<(Int a, Int b) { return {hn::RebindMask(D(), hn::Lt(a.v, b.v))}; }
OP Bool operator<=(Int a, Int b) { return {hn::RebindMask(D(), hn::Not(hn::Lt(b.v, a.v)))}; }
OP Bool operator>(Int a, Int b) { return b < a; }
OP Bool operator>=(Int a, Int b) { return b <= a; }
OP Bool operator==(Int a, Int b) { return {hn::RebindMask(D(), hn::Eq(a.v, b.v))}; }
OP Bool operator&&(Bool a, Bool b) { return {hn::And(a.m, b.m)}; }
OP Bool operator||(Bool a, Bool b) { return {hn::Or(a.m, b.m)}; }
OP Bool operator!(Bool a) { return {hn::Not(a.m)}; }
/// Compares as signed integers, after an offset by 2^31.
OP Bool operator<(Uint a, Uint b) {
  const auto flip = hn::Set(DU(), 0x80000000u);
  return {hn::RebindMask(D(), hn::Lt(hn::BitCast(DI(), hn::Xor(a.v, flip)), hn::BitCast(DI(), hn::Xor(b.v, flip))))};
}

// If an operand is NaN, scalar.h and x86 return the second one. Highway's result depends on the machine.
#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR
OP Real min(Real a, Real b) { return hn::Min(a.v, b.v); }
OP Real max(Real a, Real b) { return hn::Max(a.v, b.v); }
#else
OP Real min(Real a, Real b) { return hn::IfThenElse(hn::Lt(a.v, b.v), a.v, b.v); }
OP Real max(Real a, Real b) { return hn::IfThenElse(hn::Lt(b.v, a.v), a.v, b.v); }
#endif
OP Int min(Int a, Int b) { return hn::Min(a.v, b.v); }
OP Int max(Int a, Int b) { return hn::Max(a.v, b.v); }
OP Real clamp(Real x, Real min_value, Real max_value) { return min(max(x, min_value), max_value); }
OP Int clamp(Int x, Int min_value, Int max_value) { return min(max(x, min_value), max_value); }
OP Real abs(Real a) { return hn::Abs(a.v); }
OP Real floor(Real a) { return hn::Floor(a.v); }
OP Real fract(Real a) { return hn::Sub(a.v, hn::Floor(a.v)); }
OP Real sqrt(Real a) { return hn::Sqrt(a.v); }
/// Refines the hardware's estimate by Newton steps: relative error below 2e-7, and exactly 1 for 1. Estimates of
/// different vendors differ in the last bits. AVX-512's estimate has 14 bits and needs one step; others have 8 to 12
/// bits and need two. The scalar target has no useful estimate.
OP Real rsqrt(Real a) {
#if HWY_TARGET == HWY_SCALAR
  return hn::Div(hn::Set(D(), 1.0f), hn::Sqrt(a.v));
#else
  Real y = hn::ApproximateReciprocalSqrt(a.v);
  y = y + y * (Real(0.5f) - (a * Real(0.5f)) * (y * y));
#if HWY_TARGET != HWY_AVX3
  y = y + y * (Real(0.5f) - (a * Real(0.5f)) * (y * y));
#endif
  return y;
#endif
}
OP Real mad(Real a, Real b, Real c) {
#if HWY_NATIVE_FMA
  return hn::MulAdd(a.v, b.v, c.v);
#elif HWY_TARGET == HWY_SCALAR
  return float(double(hn::GetLane(a.v)) * double(hn::GetLane(b.v)) + double(hn::GetLane(c.v)));
#else
  // SSE has no fused multiply-add. In double precision the product is exact and the sum is rounded. The last bit of the
  // float can differ from a fused result if the sum is close to the midpoint between two floats.
  const hn::Half<D> half;
  const hn::Repartition<double, D> wide;
  const auto in_double = [&](hn::Vec<hn::Half<D> > x, hn::Vec<hn::Half<D> > y, hn::Vec<hn::Half<D> > z) HWY_ATTR {
    return hn::DemoteTo(half, hn::Add(hn::Mul(hn::PromoteTo(wide, x), hn::PromoteTo(wide, y)), hn::PromoteTo(wide, z)));
  };
  return hn::Combine(D(), in_double(hn::UpperHalf(half, a.v), hn::UpperHalf(half, b.v), hn::UpperHalf(half, c.v)),
                     in_double(hn::LowerHalf(half, a.v), hn::LowerHalf(half, b.v), hn::LowerHalf(half, c.v)));
#endif
}
// Highway's own conversion takes four more instructions, to handle values out of range.
#if HWY_TARGET == HWY_AVX3
OP Int to_int(Real a) { return hn::Vec512<std::int32_t>{_mm512_cvttps_epi32(a.v.raw)}; }
#elif HWY_TARGET == HWY_AVX2
OP Int to_int(Real a) { return hn::Vec256<std::int32_t>{_mm256_cvttps_epi32(a.v.raw)}; }
#elif HWY_TARGET == HWY_SSE4
OP Int to_int(Real a) { return hn::Vec128<std::int32_t>{_mm_cvttps_epi32(a.v.raw)}; }
#else
OP Int to_int(Real a) { return hn::ConvertTo(DI(), a.v); }
#endif
OP Uint to_uint(Int a) { return hn::BitCast(DU(), a.v); }
OP Int to_signed(Uint a) { return hn::BitCast(DI(), a.v); }
OP Real to_real(Int a) { return hn::ConvertTo(D(), a.v); }
/// Converts the two halves exactly; their sum is rounded once.
OP Real to_real(Uint a) {
  const Real high = to_real(to_signed(a >> 16)), low = to_real(to_signed(a & Uint(0xffffu)));
  return hn::Add(hn::Mul(high.v, hn::Set(D(), 65536.0f)), low.v);
}
OP Uint bits_of(Real a) { return hn::BitCast(DU(), a.v); }
OP Real real_of_bits(Uint a) { return hn::BitCast(D(), a.v); }
OP Int popcount(Uint a) { return hn::BitCast(DI(), hn::PopulationCount(a.v)); }
/// Shifts in two steps, because Highway's shift by 32 is undefined. x86's vector shift returns 0 for it.
#if HWY_TARGET == HWY_AVX3
OP Uint ones_from(Int b) { return hn::Vec512<std::uint32_t>{_mm512_sllv_epi32(_mm512_set1_epi32(-1), b.v.raw)}; }
#elif HWY_TARGET == HWY_AVX2
OP Uint ones_from(Int b) { return hn::Vec256<std::uint32_t>{_mm256_sllv_epi32(_mm256_set1_epi32(-1), b.v.raw)}; }
#else
OP Uint ones_from(Int b) {
  const DU du;
  const auto count = hn::BitCast(du, b.v);
  const auto half = hn::ShiftRight<1>(count);
  return hn::Shl(hn::Shl(hn::Set(du, ~0u), half), hn::Sub(count, half));
}
#endif
/// Returns a + b where the mask is set, else a; for vectors of 32-bit integers of any length.
template <class V, class M>
OP V masked_add(M mask, V a, V b) {
  return hn::Add(a, hn::IfThenElseZero(mask, b));
}
#if HWY_TARGET == HWY_AVX3
// A single instruction, which the compiler does not generate from the code above.
OP hn::Vec512<std::int32_t> masked_add(hn::Mask512<std::int32_t> mask, hn::Vec512<std::int32_t> a,
                                       hn::Vec512<std::int32_t> b) {
  return hn::Vec512<std::int32_t>{_mm512_mask_add_epi32(a.raw, mask.raw, a.raw, b.raw)};
}
OP hn::Vec256<std::int32_t> masked_add(hn::Mask256<std::int32_t> mask, hn::Vec256<std::int32_t> a,
                                       hn::Vec256<std::int32_t> b) {
  return hn::Vec256<std::int32_t>{_mm256_mask_add_epi32(a.raw, mask.raw, a.raw, b.raw)};
}
#endif
OP Bool is_finite(Real a) { return {hn::Le(hn::Abs(a.v), hn::Set(D(), 3.402823466e38f))}; }
OP bool some(Bool a) { return !hn::AllFalse(D(), a.m); }
OP int count_lanes(Bool a) { return int(hn::CountTrue(D(), a.m)); }
OP Int this_lane() { return hn::Iota(DI(), 0); }
OP Real lane_value(Real v, Int lane) { return hn::TableLookupLanes(v.v, hn::IndicesFromVec(D(), lane.v)); }
OP Real entry_of(const float* array, Int k) { return hn::GatherIndex(D(), array, k.v); }
OP Int entry_of(const std::int32_t* array, Int k) { return hn::GatherIndex(DI(), array, k.v); }
OP Real packed(Bool where, Real v) { return hn::Compress(v.v, where.m); }
OP Uint packed(Bool where, Uint v) { return hn::Compress(v.v, hn::RebindMask(DU(), where.m)); }

OP Real select(Bool mask, Real a, Real b) { return hn::IfThenElse(mask.m, a.v, b.v); }
OP Int select(Bool mask, Int a, Int b) { return hn::IfThenElse(hn::RebindMask(DI(), mask.m), a.v, b.v); }
OP Uint select(Bool mask, Uint a, Uint b) { return hn::IfThenElse(hn::RebindMask(DU(), mask.m), a.v, b.v); }
OP Real pow(Real a, Real b) {
  const D d;
  const auto positive = hn::Gt(a.v, hn::Zero(d));
  const auto power = hn::Exp(d, hn::Mul(b.v, hn::Log(d, hn::IfThenElse(positive, a.v, hn::Set(d, 1.0f)))));
  return hn::IfThenElseZero(positive, power);
}

#define inline OP
#include "kernel/vectors.h"
#undef inline

/// A sum per lane. The channels are interleaved, so that one vector of four floats adds them all.
struct LaneSums {
  HWY_ALIGN float sums[4 * kLanes];
};
OP void clear(LaneSums& s) {
  for (int i = 0; i < 4; ++i) hn::Store(hn::Zero(D()), D(), s.sums + i * kLanes);
}
OP void add_to_lanes(LaneSums& s, Int lane, Vec3 v) {
  const hn::CappedTag<float, 4> four;
  HWY_ALIGN float each[4 * kLanes];
  HWY_ALIGN std::int32_t to[kLanes];
  hn::StoreInterleaved4(v.x.v, v.y.v, v.z.v, hn::Zero(D()), D(), each);
  hn::Store(lane.v, DI(), to);
  for (int i = 0; i < kLanes; ++i)
    for (std::size_t k = 0; k < 4; k += hn::Lanes(four)) {
      float* sum = s.sums + 4 * to[i] + k;
      hn::Store(hn::Add(hn::Load(four, sum), hn::Load(four, each + 4 * i + k)), four, sum);
    }
}
OP Vec3 sums_of(const LaneSums& s) {
  auto x = hn::Zero(D()), y = x, z = x, none = x;
  hn::LoadInterleaved4(D(), s.sums, x, y, z, none);
  return Vec3{x, y, z};
}
#undef OP

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace umbrage
HWY_AFTER_NAMESPACE();

#endif
