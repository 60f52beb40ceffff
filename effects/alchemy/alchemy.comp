// Compiles alchemy.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/alchemy/alchemy.h"
UMBRAGE_CONSTANTS(AlchemyConstants)
#include "kernel/common.kernel.h"

#include "effects/alchemy/alchemy.kernel.h"
UMBRAGE_MAIN(alchemy)
