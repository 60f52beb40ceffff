// Compiles one kernel text for the CPU. A NAME.cpu.cpp defines, before it includes this,
//   UMBRAGE_KERNEL            its name: the text's entry is NAME_pixel(Int x, Int y)
//   UMBRAGE_KERNEL_TEXT       the path of the text
//   UMBRAGE_KERNEL_CONSTANTS  the constants struct
// and gets run_scalar_NAME and run_lanes_NAME of machine/kernel_frame.h. Included once per SIMD target.
#include <algorithm>

#include "machine/lanes.h"
#include "machine/lanes_view.h"

#define UMBRAGE_CONCAT_(a, b) a##b
#define UMBRAGE_CONCAT(a, b) UMBRAGE_CONCAT_(a, b)

HWY_BEFORE_NAMESPACE();
namespace umbrage {
namespace HWY_NAMESPACE {
namespace {

struct Kernel {
  LanesView view;
#include "machine/kernel_begin.h"

#include UMBRAGE_KERNEL_TEXT

#include "machine/kernel_end.h"
};

void Run(const KernelFrame& frame, const Tile& tile) {
  Kernel kernel{{frame}};
  const auto lane = hn::Iota(DI(), 0);  // once: it is made number by number
  for (int y = tile.y0; y < tile.y1; ++y)
    for (int x = tile.x0; x < tile.x1; x += kLanes) {
      kernel.view.move(x, y);
      kernel.UMBRAGE_CONCAT(UMBRAGE_KERNEL, _pixel)(hn::Add(lane, hn::Set(DI(), x)), Int(y));
    }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace umbrage
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "machine/scalar_view.h"

namespace umbrage {
namespace scalar {
namespace {

struct Kernel {
  ScalarView view;
#include "machine/kernel_begin.h"

#include UMBRAGE_KERNEL_TEXT

#include "machine/kernel_end.h"
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
      kernel.view.x = x;
      kernel.view.y = y;
      kernel.UMBRAGE_CONCAT(UMBRAGE_KERNEL, _pixel)(x, y);
    }
}

}  // namespace umbrage
#endif
