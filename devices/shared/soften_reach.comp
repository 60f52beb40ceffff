// Compiles soften_reach.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "devices/shared/soften.h"
UMBRAGE_CONSTANTS(SoftenConstants)
#include "kernel/common.kernel.h"

#include "devices/shared/soften_reach.kernel.h"
UMBRAGE_MAIN(soften_reach)
