// Compiles composite_parts.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/composite/composite.h"
UMBRAGE_CONSTANTS(CompositeConstants)
#include "kernel/common.kernel.h"

#include "effects/composite/composite_parts.kernel.h"
UMBRAGE_MAIN(composite_parts)
