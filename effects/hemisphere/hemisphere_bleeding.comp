// Compiles hemisphere_bleeding.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/hemisphere/hemisphere.h"
UMBRAGE_CONSTANTS(HemisphereConstants)
#include "kernel/common.kernel.h"

#include "effects/hemisphere/hemisphere_bleeding.kernel.h"
UMBRAGE_MAIN(hemisphere_bleeding)
