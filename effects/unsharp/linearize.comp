// Compiles linearize.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/unsharp/unsharp.h"
UMBRAGE_CONSTANTS(UnsharpConstants)
#include "kernel/common.kernel.h"

#include "effects/unsharp/linearize.kernel.h"
UMBRAGE_MAIN(linearize)
