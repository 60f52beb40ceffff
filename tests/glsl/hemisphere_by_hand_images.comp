// The hand-written shader hemisphere.glsl, with planes in sampled images.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "effects/hemisphere/hemisphere.h"
#include "kernel/frame_constants.h"

layout(set = 0, binding = 0, scalar) uniform constants_block {
  FrameConstants F;
  HemisphereConstants C;
};
#define PLANES_IN_IMAGES
#include "tests/glsl/by_hand.glsl"
#include "tests/glsl/hemisphere.glsl"
