// Compiles toon.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/toon/toon.h"
UMBRAGE_CONSTANTS(ToonConstants)
#include "kernel/common.kernel.h"

#include "effects/toon/toon.kernel.h"
UMBRAGE_MAIN(toon)
