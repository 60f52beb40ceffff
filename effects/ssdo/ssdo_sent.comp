// Compiles ssdo_sent.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/ssdo/ssdo.h"
UMBRAGE_CONSTANTS(SsdoConstants)
#include "kernel/common.kernel.h"

#include "effects/ssdo/ssdo_sent.kernel.h"
UMBRAGE_MAIN(ssdo_sent)
