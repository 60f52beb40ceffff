// Compiles gooch.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/gooch/gooch.h"
UMBRAGE_CONSTANTS(GoochConstants)
#include "kernel/common.kernel.h"

#include "effects/gooch/gooch.kernel.h"
UMBRAGE_MAIN(gooch)
