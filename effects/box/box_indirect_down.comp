// Compiles box_indirect_down.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/box/box.h"
UMBRAGE_CONSTANTS(BoxConstants)
#include "kernel/common.kernel.h"

#include "effects/box/box_indirect_down.kernel.h"
UMBRAGE_MAIN(box_indirect_down)
