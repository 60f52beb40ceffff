// The hand-written shader bitmask.glsl, with planes read by their addresses.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require
#include "effects/bitmask/bitmask.h"
#include "kernel/frame_constants.h"

layout(set = 0, binding = 0, scalar) uniform constants_block {
  FrameConstants F;
  BitmaskConstants C;
  uvec2 planes[4];  // depth, normal
};
#define PLANES_IN_ADDRESSES
#include "tests/glsl/by_hand.glsl"
#include "tests/glsl/bitmask.glsl"
