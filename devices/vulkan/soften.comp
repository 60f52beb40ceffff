// Soft shadows without their grain, along a row or a column: devices/cpu/soften.cpp.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#include "devices/vulkan/capture.h"
#include "machine/frame_constants.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, scalar) uniform constants_block { SoftenConstants C; };
layout(set = 0, binding = 1, scalar) uniform table_block { uvec2 table[kMostPlanes]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) restrict readonly buffer InPlane { float at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer OutPlane { float at[]; };

const int kReach = 2;
const float kOffPlane = 1.5f;
const float kFacing = 0.8f;

float depth_at(int place) { return InPlane(table[kSoftDepthSlot]).at[place]; }
vec3 normal_at(int place) {
  return vec3(InPlane(table[kSoftNormalSlot]).at[place], InPlane(table[kSoftNormalSlot + 1]).at[place],
              InPlane(table[kSoftNormalSlot + 2]).at[place]);
}

// How far a pixel's point lies along a normal.
float along(int x, int y, vec3 normal) {
  float z = depth_at(y * C.stride + x);
  float spread = C.orthographic != 0 ? 1.0f : z;
  float px = (C.left + (float(x) + 0.5f) * C.per_x) * spread, py = (C.top - (float(y) + 0.5f) * C.per_y) * spread;
  return normal.x * px + normal.y * py - normal.z * z;
}

void main() {
  ivec2 here = ivec2(gl_GlobalInvocationID.xy);
  if (here.x >= C.width || here.y >= C.height) return;
  int place = here.y * C.stride + here.x;
  InPlane from = InPlane(table[kSoftFromSlot]);
  float own = from.at[place], depth = depth_at(place), result = own;
  if (depth <= 3.402823466e38f) {
    vec3 normal = normal_at(place);
    float own_along = along(here.x, here.y, normal), size = C.per_x * (C.orthographic != 0 ? 1.0f : depth);
    float sum = 0.0f, weights = 0.0f;
    for (int k = -kReach; k <= kReach; ++k) {
      int x = here.x + k * C.dx, y = here.y + k * C.dy;
      if (x < 0 || x >= C.width || y < 0 || y >= C.height) continue;
      int there = y * C.stride + x;
      bool alike = abs(along(x, y, normal) - own_along) < kOffPlane * size && dot(normal, normal_at(there)) > kFacing;
      if (!alike && k != 0) continue;
      float weight = abs(k) == kReach ? 0.5f : 1.0f;
      sum += weight * from.at[there];
      weights += weight;
    }
    result = sum / weights;
  }
  OutPlane(table[kSoftToSlot]).at[place] = result;
}
