// The hand-written shader hemisphere.glsl, with planes read by their addresses (addresses.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require
#include "effects/hemisphere/hemisphere.h"
#include "kernel/frame_constants.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, scalar) uniform constants_block {
  FrameConstants F;
  HemisphereConstants C;
  uvec2 planes[4];  // depth, normal
};
layout(set = 0, binding = 5, scalar) writeonly buffer ao_plane { float ao[]; };
#include "tests/glsl/addresses.glsl"

#include "tests/glsl/position.glsl"
#include "tests/glsl/hemisphere.glsl"
#include "tests/glsl/main.glsl"
