// The planes of a frame as lanes see them: this pixel and its right-hand neighbours. Included once per SIMD target.
#if defined(UMBRAGE_MACHINE_LANES_VIEW_H) == defined(HWY_TARGET_TOGGLE)
#ifdef UMBRAGE_MACHINE_LANES_VIEW_H
#undef UMBRAGE_MACHINE_LANES_VIEW_H
#else
#define UMBRAGE_MACHINE_LANES_VIEW_H
#endif

#include <cstddef>

#include "machine/kernel_frame.h"
#include "machine/lanes.h"

HWY_BEFORE_NAMESPACE();
namespace umbrage {
namespace HWY_NAMESPACE {
namespace {

// Neighbours up to so many pixels away are read without looking for the border, where it is farther.
constexpr int kMargin = 32;
// The same in blocks of up to 4 x 4 pixels, with room for the one that holds the pixel.
constexpr int kMarginBlocks = 4;

struct LanesView {
  const KernelFrame& frame;
  float real_stride = float(frame.frame.stride);
  // Floats hold all places in a plane.
  bool exact = (std::int64_t(frame.frame.height) + 1) * frame.frame.stride <= 1 << 24;
  int x = 0, y = 0;         // the first lane's pixel
  bool inner = false;       // all lanes lie kMargin or more inside the picture
  std::ptrdiff_t here = 0;  // of pixel (x, y) in a plane

  HWY_INLINE void move(int to_x, int to_y) {
    x = to_x;
    y = to_y;
    inner =
        x >= kMargin && x + kLanes + kMargin <= frame.frame.width && y >= kMargin && y + kMargin < frame.frame.height;
    here = std::ptrdiff_t(y) * frame.frame.stride + x;
  }

  float* plane(std::string_view name) const { return frame.plane(name); }
  HWY_INLINE Real load(const float* plane, Int X, Int Y) const {
    const Int column = clamp(X, Int(0), Int(frame.frame.width - 1));
    const Int row = clamp(Y, Int(0), Int(frame.frame.height - 1));
    return hn::GatherIndex(D(), plane, (row * Int(frame.frame.stride) + column).v);
  }
  HWY_INLINE Int place_of(Real X, Real Y) const {
    if (HWY_LIKELY(exact)) return to_int(Y * Real(real_stride) + X);
    return to_int(Y) * Int(frame.frame.stride) + to_int(X);
  }
  HWY_INLINE Real read(const float* plane, Int place) const { return hn::GatherIndex(D(), plane, place.v); }
  HWY_INLINE void write(float* list, Real v) const { hn::StoreU(v.v, D(), list); }
  HWY_INLINE void write(std::uint32_t* list, Uint v) const { hn::StoreU(v.v, DU(), list); }
  HWY_INLINE Real listed(const float* list) const { return hn::LoadU(D(), list); }
  HWY_INLINE Uint listed(const std::uint32_t* list) const { return hn::LoadU(DU(), list); }
  HWY_INLINE Real near(const float* plane, int i, int j) const {
    const bool close = unsigned(i + kMargin) <= 2u * kMargin && unsigned(j + kMargin) <= 2u * kMargin;
    if (HWY_LIKELY(inner && close)) return hn::LoadU(D(), plane + here + std::ptrdiff_t(j) * frame.frame.stride + i);
    return near_border(plane, i, j);
  }
  HWY_NOINLINE Real near_border(const float* plane, int i, int j) const {
    const int row = HWY_MIN(HWY_MAX(y + j, 0), frame.frame.height - 1);
    const int column = x + i;
    const float* start = plane + std::ptrdiff_t(row) * frame.frame.stride;
    if (column >= 0 && column + kLanes <= frame.frame.width) return hn::LoadU(D(), start + column);
    return hn::GatherIndex(D(), start, clamp(Int(hn::Iota(DI(), column)), Int(0), Int(frame.frame.width - 1)).v);
  }
  // Loads by steps of f, 1, 2 or 4: lanes start at a multiple of it wherever they are as many as f.
  HWY_INLINE Real corner(const float* plane, int f, int i, int j) const {
#if HWY_TARGET != HWY_SCALAR
    const bool close =
        unsigned(i + kMarginBlocks) <= 2u * kMarginBlocks && unsigned(j + kMarginBlocks) <= 2u * kMarginBlocks;
    if (HWY_LIKELY(inner && close)) {
      const auto v = hn::LoadU(D(), plane + here + std::ptrdiff_t(j * f - (y & (f - 1))) * frame.frame.stride + i * f);
      return f == 4 ? hn::Broadcast<0>(v) : f == 2 ? hn::DupEven(v) : v;
    }
#endif
    return corner_border(plane, f, i, j);
  }
  HWY_NOINLINE Real corner_border(const float* plane, int f, int i, int j) const {
    const int row = HWY_MIN(HWY_MAX((y / f + j) * f, 0), frame.frame.height - 1);
    const float* start = plane + std::ptrdiff_t(row) * frame.frame.stride;
    const Int first = hn::AndNot(hn::Set(DI(), f - 1), hn::Iota(DI(), x));
    return hn::GatherIndex(D(), start, clamp(first + Int(i * f), Int(0), Int(frame.frame.width - 1)).v);
  }
  HWY_INLINE Real block(const float* plane, int f, int i, int j) const {
    const int shift = f / 2;
#if HWY_TARGET != HWY_SCALAR
    const bool close =
        unsigned(i + kMarginBlocks) <= 2u * kMarginBlocks && unsigned(j + kMarginBlocks) <= 2u * kMarginBlocks;
    if (HWY_LIKELY(inner && close))
      return hn::TableLookupLanes(
          hn::LoadU(D(), plane + std::ptrdiff_t((y >> shift) + j) * frame.frame.stride + (x >> shift) + i),
          hn::IndicesFromVec(D(), hn::ShiftRightSame(hn::Iota(DI(), 0), shift)));
#endif
    return block_border(plane, shift, i, j);
  }
  HWY_NOINLINE Real block_border(const float* plane, int shift, int i, int j) const {
    const int row = HWY_MIN(HWY_MAX((y >> shift) + j, 0), frame.frame.height - 1);
    const Int at = Int(hn::ShiftRightSame(hn::Iota(DI(), x), shift)) + Int(i);
    return hn::GatherIndex(D(), plane + std::ptrdiff_t(row) * frame.frame.stride,
                           clamp(at, Int(0), Int(frame.frame.width - 1)).v);
  }
  HWY_INLINE Bool inside(int i, int j) const {
    if (HWY_LIKELY(inner && unsigned(i + kMargin) <= 2u * kMargin && unsigned(j + kMargin) <= 2u * kMargin))
      return Int(0) == Int(0);
    const Int column = hn::Iota(DI(), x + i);
    const bool row = y + j >= 0 && y + j < frame.frame.height;
    return column >= Int(row ? 0 : 0x7fffffff) && column < Int(frame.frame.width);
  }
  HWY_INLINE void store(float* plane, Real v) const { hn::StoreU(v.v, D(), plane + here); }
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace umbrage
HWY_AFTER_NAMESPACE();

#endif
