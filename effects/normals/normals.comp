// Compiles normals.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/normals/normals.h"
UMBRAGE_CONSTANTS(NormalsConstants)
#include "kernel/common.kernel.h"

#include "effects/normals/normals.kernel.h"
UMBRAGE_MAIN(normals)
