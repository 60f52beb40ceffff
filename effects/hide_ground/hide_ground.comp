// Compiles hide_ground.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/hide_ground/hide_ground.h"
UMBRAGE_CONSTANTS(HideGroundConstants)
#include "kernel/common.kernel.h"

#include "effects/hide_ground/hide_ground.kernel.h"
UMBRAGE_MAIN(hide_ground)
