// Names the kernel text toon_light.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "machine/glsl.h"

#include "effects/toon/toon.h"
UMBRAGE_CONSTANTS(ToonConstants)
#include "machine/common.kernel.h"

#include "effects/toon/toon_light.kernel.h"
UMBRAGE_MAIN(toon_light)
