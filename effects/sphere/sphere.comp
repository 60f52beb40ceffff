// Compiles sphere.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/sphere/sphere.h"
UMBRAGE_CONSTANTS(SphereConstants)
#include "kernel/common.kernel.h"

#include "effects/sphere/sphere.kernel.h"
UMBRAGE_MAIN(sphere)
