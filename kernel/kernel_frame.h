// KernelFrame: input and output of a kernel on the CPU.
#pragma once
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "kernel/frame_constants.h"

namespace umbrage {

/// Pixels [x0, x1) x [y0, y1). x0 is a multiple of 16, so that lanes of two tiles never store to one pixel.
struct Tile {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

struct KernelPlane {
  std::string_view name;
  float* data;  ///< address of pixel (0, 0), even if row 0 is not in memory; rows are FrameConstants::stride apart
};

struct KernelFrame {
  FrameConstants frame;
  const void* constants;  ///< the effect's constants struct
  std::span<const KernelPlane> planes;
  const float* ao = nullptr;              ///< plane `ao`; null unless FrameConstants::missing is set
  int first_row = 0, last_row = 1 << 30;  ///< rows in memory, inclusive; load_NAME clamps to them

  /// Returns the plane of that name. Throws std::logic_error if the dispatch's table does not list it.
  float* plane(std::string_view name) const;
};

/// Returns the address that row 0 of a plane would have if row `first` is at `data`.
inline float* row_zero(float* data, int stride, int first) {
  // In integers, since it may lie outside the allocation: NOLINTNEXTLINE(performance-no-int-to-ptr)
  return reinterpret_cast<float*>(reinterpret_cast<std::uintptr_t>(data) -
                                  std::uintptr_t(first) * std::uintptr_t(stride) * sizeof(float));
}

/// Returns the names of the planes on every layer, as a dispatch's table lists them for IN_LAYERS_REAL and the like:
/// `depth`, `layer1.depth` and so on.
std::vector<std::string_view> of_all_layers(const std::vector<std::string_view>& planes);

}  // namespace umbrage
