// The hand-written shader bitmask.glsl, with planes in sampled images (images.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "effects/bitmask/bitmask.h"
#include "kernel/frame_constants.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, scalar) uniform constants_block {
  FrameConstants F;
  BitmaskConstants C;
};
layout(set = 0, binding = 5, scalar) writeonly buffer ao_plane { float ao[]; };
#include "tests/glsl/images.glsl"

#include "tests/glsl/position.glsl"
#include "tests/glsl/bitmask.glsl"
#include "tests/glsl/main.glsl"
