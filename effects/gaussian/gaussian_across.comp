// Compiles gaussian_across.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/gaussian/gaussian.h"
UMBRAGE_CONSTANTS(GaussianConstants)
#include "kernel/common.kernel.h"

#include "effects/gaussian/gaussian_across.kernel.h"
UMBRAGE_MAIN(gaussian_across)
