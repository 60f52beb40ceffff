// Compiles hbao.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/hbao/hbao.h"
UMBRAGE_CONSTANTS(HbaoConstants)
#include "kernel/common.kernel.h"

#include "effects/hbao/hbao.kernel.h"
UMBRAGE_MAIN(hbao)
