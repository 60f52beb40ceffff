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

struct LanesView {
  const KernelFrame& frame;
  int x = 0, y = 0;  // the first lane's pixel

  float* plane(std::string_view name) const { return frame.plane(name); }
  HWY_INLINE Real load(const float* plane, Int X, Int Y) const {
    const Int column = clamp(X, Int(0), Int(frame.frame.width - 1));
    const Int row = clamp(Y, Int(0), Int(frame.frame.height - 1));
    return hn::GatherIndex(D(), plane, (row * Int(frame.frame.stride) + column).v);
  }
  HWY_INLINE Real near(const float* plane, int i, int j) const {
    const int row = HWY_MIN(HWY_MAX(y + j, 0), frame.frame.height - 1);
    const int column = x + i;
    const float* start = plane + std::ptrdiff_t(row) * frame.frame.stride;
    if (column >= 0 && column + kLanes <= frame.frame.width) return hn::LoadU(D(), start + column);
    return hn::GatherIndex(D(), start, clamp(Int(hn::Iota(DI(), column)), Int(0), Int(frame.frame.width - 1)).v);
  }
  HWY_INLINE Bool inside(int i, int j) const {
    const Int column = hn::Iota(DI(), x + i);
    const bool row = y + j >= 0 && y + j < frame.frame.height;
    return column >= Int(row ? 0 : 0x7fffffff) && column < Int(frame.frame.width);
  }
  HWY_INLINE void store(float* plane, Real v) const {
    hn::StoreU(v.v, D(), plane + std::ptrdiff_t(y) * frame.frame.stride + x);
  }
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace umbrage
HWY_AFTER_NAMESPACE();

#endif
