// Compiles antialias_beauty.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/antialias/antialias.h"
UMBRAGE_CONSTANTS(AntialiasConstants)
#include "kernel/common.kernel.h"

#include "effects/antialias/antialias_beauty.kernel.h"
UMBRAGE_MAIN(antialias_beauty)
