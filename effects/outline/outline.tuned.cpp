// The same bits as outline.kernel.h in lanes, faster: lines are sparse, so blocks of pixels that no crossing reaches
// keep their light and are not looked at again.
//
// scene:solids at 1024x1024, 2 px: see docs/performance.md.
#include <algorithm>
#include <cmath>
#include <vector>

#include "effects/outline/outline.h"
#include "machine/kernel_frame.h"

namespace umbrage {

UMBRAGE_DECLARE_KERNEL(outline)

namespace {

constexpr int kBlockWidth = 16, kBlockHeight = 8;

/// Whether any of the planes is above 0 in the pixels from (x0, y0) to before (x1, y1).
bool any_crossing(const KernelFrame& frame, const float* steep, const float* flat, int x0, int y0, int x1, int y1) {
  x0 = std::max(x0, 0);
  y0 = std::max(y0, 0);
  x1 = std::min(x1, frame.frame.width);
  y1 = std::min(y1, frame.frame.height);
  for (int y = y0; y < y1; ++y) {
    const std::size_t row = std::size_t(y) * frame.frame.stride;
    float most = 0.0f;
    for (int x = x0; x < x1; ++x) most += steep[row + x] + flat[row + x];  // neither is ever below 0
    if (most > 0.0f) return true;
  }
  return false;
}

float finite_or_zero(float v) { return std::fabs(v) <= 3.402823466e38f ? v : 0.0f; }

/// What the kernel does where nothing is covered.
void leave(const KernelFrame& frame, const Tile& tile) {
  const float* depth = frame.plane("depth");
  float* outline = frame.plane("outline");
  for (const char* name : {"lit.r", "lit.g", "lit.b"}) {
    float* lit = frame.plane(name);
    for (int y = tile.y0; y < tile.y1; ++y)
      for (int x = tile.x0; x < tile.x1; ++x) {
        const std::size_t at = std::size_t(y) * frame.frame.stride + x;
        const bool surface = depth[at] > 0.0f && depth[at] <= 3.402823466e38f;
        lit[at] = surface ? finite_or_zero(lit[at]) : 0.0f;
      }
  }
  for (int y = tile.y0; y < tile.y1; ++y)
    std::fill_n(outline + std::size_t(y) * frame.frame.stride + tile.x0, tile.x1 - tile.x0, 0.0f);
}

}  // namespace

void run_tuned_outline(const KernelFrame& frame, const Tile& tile) {
  const auto& c = *static_cast<const OutlineConstants*>(frame.constants);
  if (c.mode == kOutlinePaper) return run_lanes_outline(frame, tile);
  const float* steep = frame.plane("outline_steep");
  const float* flat = frame.plane("outline_flat");
  const int reach = c.reach_along;
  for (int y0 = tile.y0; y0 < tile.y1; y0 += kBlockHeight) {
    const int y1 = std::min(y0 + kBlockHeight, tile.y1);
    // Neighbouring blocks of one kind are one call.
    for (int x0 = tile.x0; x0 < tile.x1;) {
      const auto busy = [&](int x) {
        return any_crossing(frame, steep, flat, x - reach, y0 - reach, x + kBlockWidth + reach, y1 + reach);
      };
      const bool first = busy(x0);
      int x1 = x0 + kBlockWidth;
      while (x1 < tile.x1 && busy(x1) == first) x1 += kBlockWidth;
      x1 = std::min(x1, tile.x1);
      const Tile part{x0, y0, x1, y1};
      first ? run_lanes_outline(frame, part) : leave(frame, part);
      x0 = x1;
    }
  }
}

}  // namespace umbrage
