// Compiles output_parts.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/output/output.h"
UMBRAGE_CONSTANTS(OutputConstants)
#include "kernel/common.kernel.h"

#include "effects/output/output_parts.kernel.h"
UMBRAGE_MAIN(output_parts)
