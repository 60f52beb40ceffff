// Compiles resample_widen.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/resample/resample.h"
UMBRAGE_CONSTANTS(ResampleConstants)
#include "kernel/common.kernel.h"

#include "effects/resample/resample_widen.kernel.h"
UMBRAGE_MAIN(resample_widen)
