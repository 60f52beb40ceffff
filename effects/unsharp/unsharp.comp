// Compiles unsharp.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/unsharp/unsharp.h"
UMBRAGE_CONSTANTS(UnsharpConstants)
#include "kernel/common.kernel.h"

#include "effects/unsharp/unsharp.kernel.h"
UMBRAGE_MAIN(unsharp)
