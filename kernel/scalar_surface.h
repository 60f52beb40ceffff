// The scalar form of kernel/surface.kernel.h outside of kernels: for host_surface.cpu.cpp and tests.
#pragma once
#include "kernel/frame_constants.h"
#include "kernel/scalar.h"

namespace umbrage::scalar {

/// Functions for one picture: F must have `orthographic` and the scales and offsets of rays.
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
