// Compiles hatching_down.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/hatching/hatching.h"
UMBRAGE_CONSTANTS(HatchingConstants)
#include "kernel/common.kernel.h"

#include "effects/hatching/hatching_down.kernel.h"
UMBRAGE_MAIN(hatching_down)
