// kernel/surface.kernel.h in its scalar form, outside of a kernel: for host_surface.cpu.cpp, and for tests.
#pragma once
#include "kernel/frame_constants.h"
#include "kernel/scalar.h"

namespace umbrage::scalar {

/// Of a picture: F must have `orthographic` and the rays' scales and offsets.
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
