// Compiles lighting.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/lighting/lighting.h"
UMBRAGE_CONSTANTS(LightingConstants)
#include "kernel/common.kernel.h"

#include "effects/lighting/lighting.kernel.h"
UMBRAGE_MAIN(lighting)
