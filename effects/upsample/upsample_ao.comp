// Compiles upsample_ao.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/upsample/upsample.h"
UMBRAGE_CONSTANTS(UpsampleConstants)
#include "kernel/common.kernel.h"

#include "effects/upsample/upsample_ao.kernel.h"
UMBRAGE_MAIN(upsample_ao)
