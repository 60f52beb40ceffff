// Compiles traced_joints.kernel.h for Vulkan.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/traced/traced.h"
UMBRAGE_CONSTANTS(TracedConstants)
#include "kernel/common.kernel.h"

#include "effects/traced/traced_joints.kernel.h"
UMBRAGE_MAIN(traced_joints)
