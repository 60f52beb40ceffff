// The scalar form of kernel/surface.kernel.h for use outside kernels: in host_surface.cpp and tests.
#pragma once
#include "kernel/frame_constants.h"
#include "kernel/scalar.h"

namespace umbrage::scalar {

/// The functions for one picture. Of F, `orthographic`, ray_scale_* and ray_offset_* must be set.
struct SurfaceText {
  FrameConstants F{};
#define FN inline
#define CONST static constexpr
#include "kernel/common.kernel.h"
#include "kernel/surface.kernel.h"
#undef FN
#undef CONST
};

}  // namespace umbrage::scalar
