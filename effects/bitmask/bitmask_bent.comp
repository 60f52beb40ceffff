// Compiles bitmask_bent.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/bitmask/bitmask.h"
UMBRAGE_CONSTANTS(BitmaskConstants)
#include "kernel/common.kernel.h"

#include "effects/bitmask/bitmask_bent.kernel.h"
UMBRAGE_MAIN(bitmask_bent)
