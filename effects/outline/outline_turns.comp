// Compiles outline_turns.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/outline/outline.h"
UMBRAGE_CONSTANTS(OutlineConstants)
#include "kernel/common.kernel.h"

#include "effects/outline/outline_turns.kernel.h"
UMBRAGE_MAIN(outline_turns)
