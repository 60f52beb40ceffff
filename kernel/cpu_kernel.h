// Compiles one kernel for the CPU. The build writes a source file that includes this one for each of its kernels
// (cmake/kernels.cmake), and before it defines
//   UMBRAGE_KERNEL            the kernel's NAME
//   UMBRAGE_KERNEL_PIXEL      its entry point, a function of (Int x, Int y)
//   UMBRAGE_KERNEL_TEXT       the path of its text
//   UMBRAGE_KERNEL_CONSTANTS  the constants struct
// This file then defines run_scalar_NAME and run_lanes_NAME, which kernels/NAME.h declares. It is included once per
// SIMD target.
#include <algorithm>

#include "kernel/lanes.h"
#include "kernel/lanes_view.h"

#define UMBRAGE_CONCAT_(a, b) a##b
#define UMBRAGE_CONCAT(a, b) UMBRAGE_CONCAT_(a, b)
#define UMBRAGE_OF_KERNEL(name) UMBRAGE_CONCAT(name, UMBRAGE_KERNEL)
// They expand their argument, which Highway's macros do not.
#define UMBRAGE_EXPORT(name) HWY_EXPORT(name)
#define UMBRAGE_DISPATCH(name) HWY_DYNAMIC_DISPATCH(name)

namespace umbrage {
void UMBRAGE_OF_KERNEL(run_scalar_)(const KernelFrame& frame, const Tile& tile);
}  // namespace umbrage

#if HWY_TARGET == HWY_SCALAR
// On machines without vectors only the scalar form is compiled.
namespace umbrage {
namespace HWY_NAMESPACE {
namespace {

void UMBRAGE_OF_KERNEL(Run_)(const KernelFrame& frame, const Tile& tile) {
  UMBRAGE_OF_KERNEL(run_scalar_)(frame, tile);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace umbrage
#else
HWY_BEFORE_NAMESPACE();
namespace umbrage {
namespace HWY_NAMESPACE {
namespace {

struct UMBRAGE_OF_KERNEL(Kernel_) {
  LanesView view;
#include "kernel/kernel_begin.h"

#include UMBRAGE_KERNEL_TEXT

#include "kernel/kernel_end.h"
};

void UMBRAGE_OF_KERNEL(Run_)(const KernelFrame& frame, const Tile& tile) {
  TilePixels pixels(frame, tile);
  // Returns before the planes are looked up by name, which takes time.
  if (!pixels.next()) return;
  const bool packs = pixels.packs;
  UMBRAGE_OF_KERNEL(Kernel_) kernel{{frame}};
  const auto lane = hn::Iota(DI(), 0);  // computed once, since it is expensive
  do {
    const int y = pixels.y, end = pixels.end;
    for (int x = pixels.x; x < end; x += kLanes) {
      Int px = hn::Add(lane, hn::Set(DI(), x)), py = y;
      if (HWY_LIKELY(!packs)) {
        kernel.view.move(x, y);
      } else {
        px = pixels.columns;
        py = pixels.rows;
        kernel.view.move_to(px, py);
      }
      kernel.UMBRAGE_KERNEL_PIXEL(px, py);  // the only call site, since the kernel is inlined
    }
  } while (pixels.next());
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace umbrage
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
#include "kernel/scalar_view.h"

namespace umbrage {
namespace scalar {
namespace {

struct UMBRAGE_OF_KERNEL(Kernel_) {
  ScalarView view;
#include "kernel/kernel_begin.h"

#include UMBRAGE_KERNEL_TEXT

#include "kernel/kernel_end.h"
};

}  // namespace
}  // namespace scalar

namespace {
UMBRAGE_EXPORT(UMBRAGE_OF_KERNEL(Run_));
}  // namespace

void UMBRAGE_OF_KERNEL(run_lanes_)(const KernelFrame& frame, const Tile& tile) {
  UMBRAGE_DISPATCH(UMBRAGE_OF_KERNEL(Run_))(frame, tile);
}

void UMBRAGE_OF_KERNEL(run_scalar_)(const KernelFrame& frame, const Tile& tile) {
  scalar::UMBRAGE_OF_KERNEL(Kernel_) kernel{{frame}};
  for (int y = tile.y0; y < tile.y1; ++y)
    for (int x = tile.x0; x < tile.x1; ++x) {
      if (!kernel.view.is_computed(x, y)) continue;
      kernel.view.x = x;
      kernel.view.y = y;
      kernel.UMBRAGE_KERNEL_PIXEL(x, y);
    }
}

}  // namespace umbrage
#endif

#undef UMBRAGE_DISPATCH
#undef UMBRAGE_EXPORT
#undef UMBRAGE_OF_KERNEL
#undef UMBRAGE_CONCAT
#undef UMBRAGE_CONCAT_
#undef UMBRAGE_KERNEL
#undef UMBRAGE_KERNEL_PIXEL
#undef UMBRAGE_KERNEL_TEXT
