// Compiles one kernel for the CPU. Before it includes this file, a NAME.cpu.cpp defines
//   UMBRAGE_KERNEL            the kernel's NAME; its entry point is NAME_pixel(Int x, Int y)
//   UMBRAGE_KERNEL_TEXT       the path of the kernel's text
//   UMBRAGE_KERNEL_CONSTANTS  the constants struct
// This file then defines run_scalar_NAME and run_lanes_NAME, which kernels/NAME.h declares. It is included once per
// SIMD target.
#include <algorithm>

#include "kernel/lanes.h"
#include "kernel/lanes_view.h"

#define UMBRAGE_CONCAT_(a, b) a##b
#define UMBRAGE_CONCAT(a, b) UMBRAGE_CONCAT_(a, b)

namespace umbrage {
void UMBRAGE_CONCAT(run_scalar_, UMBRAGE_KERNEL)(const KernelFrame& frame, const Tile& tile);
}  // namespace umbrage

#if HWY_TARGET == HWY_SCALAR
// On machines without vectors only the scalar form is compiled.
namespace umbrage {
namespace HWY_NAMESPACE {
namespace {

void Run(const KernelFrame& frame, const Tile& tile) { UMBRAGE_CONCAT(run_scalar_, UMBRAGE_KERNEL)(frame, tile); }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace umbrage
#else
HWY_BEFORE_NAMESPACE();
namespace umbrage {
namespace HWY_NAMESPACE {
namespace {

struct Kernel {
  LanesView view;
#include "kernel/kernel_begin.h"

#include UMBRAGE_KERNEL_TEXT

#include "kernel/kernel_end.h"
};

void Run(const KernelFrame& frame, const Tile& tile) {
  TilePixels pixels(frame, tile);
  // Returns before the planes are looked up by name, which takes time.
  if (!pixels.next()) return;
  const bool packs = pixels.packs;
  Kernel kernel{{frame}};
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
      kernel.UMBRAGE_CONCAT(UMBRAGE_KERNEL, _pixel)(px, py);  // the only call site, since the kernel is inlined
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

struct Kernel {
  ScalarView view;
#include "kernel/kernel_begin.h"

#include UMBRAGE_KERNEL_TEXT

#include "kernel/kernel_end.h"
};

}  // namespace
}  // namespace scalar

namespace {
HWY_EXPORT(Run);
}  // namespace

void UMBRAGE_CONCAT(run_lanes_, UMBRAGE_KERNEL)(const KernelFrame& frame, const Tile& tile) {
  HWY_DYNAMIC_DISPATCH(Run)(frame, tile);
}

void UMBRAGE_CONCAT(run_scalar_, UMBRAGE_KERNEL)(const KernelFrame& frame, const Tile& tile) {
  scalar::Kernel kernel{{frame}};
  for (int y = tile.y0; y < tile.y1; ++y)
    for (int x = tile.x0; x < tile.x1; ++x) {
      if (!kernel.view.is_computed(x, y)) continue;
      kernel.view.x = x;
      kernel.view.y = y;
      kernel.UMBRAGE_CONCAT(UMBRAGE_KERNEL, _pixel)(x, y);
    }
}

}  // namespace umbrage
#endif
