// Compiles ground.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/ground/ground.h"
UMBRAGE_CONSTANTS(GroundConstants)
#include "kernel/common.kernel.h"

#include "effects/ground/ground.kernel.h"
UMBRAGE_MAIN(ground)
