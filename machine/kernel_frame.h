// KernelFrame: what a compiled kernel gets on the CPU.
#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "machine/frame_constants.h"

namespace umbrage {

/// Pixels [x0, x1) x [y0, y1). x0 is a multiple of 16, so that lanes of two tiles never store to one pixel.
struct Tile {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

struct KernelPlane {
  std::string_view name;
  float* data;  ///< pixel (0, 0); rows are FrameConstants::stride floats apart
};

struct KernelFrame {
  FrameConstants frame;
  const void* constants;  ///< the effect's constants struct
  std::span<const KernelPlane> planes;
  const float* ao = nullptr;  ///< where FrameConstants::missing is set

  /// The plane of that name; aborts where the effect's table does not list it.
  float* plane(std::string_view name) const;
};

/// Planes of which a kernel reads every layer (IN_LAYERS_REAL and its like), as a pass lists them: `depth`,
/// `layer1.depth` and so on.
std::vector<std::string_view> of_all_layers(const std::vector<std::string_view>& planes);

}  // namespace umbrage

/// Declares the two compiled forms of a kernel: run_scalar_NAME and run_lanes_NAME, made by machine/cpu_kernel.h.
#define UMBRAGE_DECLARE_KERNEL(name)                       \
  void run_scalar_##name(const KernelFrame&, const Tile&); \
  void run_lanes_##name(const KernelFrame&, const Tile&);
