// Compiles outline_color.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/outline/outline.h"
UMBRAGE_CONSTANTS(OutlineConstants)
#include "kernel/common.kernel.h"

#include "effects/outline/outline_color.kernel.h"
UMBRAGE_MAIN(outline_color)
