// Compiles denoise_ao_down.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/denoise/denoise.h"
UMBRAGE_CONSTANTS(DenoiseConstants)
#include "kernel/common.kernel.h"

#include "effects/denoise/denoise_ao_down.kernel.h"
UMBRAGE_MAIN(denoise_ao_down)
