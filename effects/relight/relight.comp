// Compiles relight.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/relight/relight.h"
UMBRAGE_CONSTANTS(RelightConstants)
#include "kernel/common.kernel.h"

#include "effects/relight/relight.kernel.h"
UMBRAGE_MAIN(relight)
