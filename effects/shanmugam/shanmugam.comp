// Compiles shanmugam.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/shanmugam/shanmugam.h"
UMBRAGE_CONSTANTS(ShanmugamConstants)
#include "kernel/common.kernel.h"

#include "effects/shanmugam/shanmugam.kernel.h"
UMBRAGE_MAIN(shanmugam)
