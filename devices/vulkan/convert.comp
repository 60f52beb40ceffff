// Converts texels of a caller's image to planes, or back. The table contains the addresses of the texels and of up to
// four planes; 0: no such plane.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#include "devices/vulkan/convert.h"
#include "kernel/frame_constants.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, scalar) uniform constants_block { ConvertConstants C; };
layout(set = 0, binding = 1, scalar) uniform table_block { uvec2 table[kMaxPlanes]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Words { uint at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Reals { float at[]; };

const float kInfinity = 1.0f / 0.0f;

vec3 linear_from_srgb(vec3 v) {
  return mix(pow((v + 0.055f) / 1.055f, vec3(2.4f)), v / 12.92f, lessThanEqual(v, vec3(0.04045f)));
}
vec3 srgb_from_linear(vec3 v) {
  return mix(1.055f * pow(v, vec3(1.0f / 2.4f)) - 0.055f, v * 12.92f, lessThanEqual(v, vec3(0.0031308f)));
}

vec4 texel(int k) {
  Words from = Words(table[0]);
  if (C.format == kFloat1) return vec4(uintBitsToFloat(from.at[k]), 0.0f, 0.0f, 1.0f);
  if (C.format == kFloat4)
    return vec4(uintBitsToFloat(from.at[4 * k]), uintBitsToFloat(from.at[4 * k + 1]),
                uintBitsToFloat(from.at[4 * k + 2]), uintBitsToFloat(from.at[4 * k + 3]));
  if (C.format == kHalf4) return vec4(unpackHalf2x16(from.at[2 * k]), unpackHalf2x16(from.at[2 * k + 1]));
  vec4 v = unpackUnorm4x8(from.at[k]);
  if (C.format == kBytes4Swapped) v = v.bgra;
  if (C.srgb != 0) v.rgb = linear_from_srgb(v.rgb);
  return v;
}

float view_depth(float d, ivec2 here) {
  if (C.role == kViewDepthRole || C.role == kRayDepthRole) {
    if (!(d > 0.0f && d <= 3.402823466e38f)) return kInfinity;
    if (C.role == kViewDepthRole || C.orthographic != 0) return d;
    vec2 at = (vec2(here) + 0.5f) / vec2(C.width, C.height);
    return d / length(vec3(mix(C.left, C.right, at.x), mix(C.top, C.bottom, at.y), 1.0f));
  }
  if (C.role == kWindowDepthRole) d = 1.0f - d;
  if (!(d > 0.0f)) return kInfinity;  // the far plane: nothing was drawn
  float far = C.far_depth, near = C.near_depth;
  if (C.orthographic != 0) return far - d * (far - near);
  if (!(far <= 3.402823466e38f)) return near / d;
  return near * far / (near + d * (far - near));
}

void store(int slot, int index, float v) {
  if ((table[slot].x | table[slot].y) != 0u) Reals(table[slot]).at[index] = v;
}
float load(int slot, int index, float otherwise) {
  return (table[slot].x | table[slot].y) != 0u ? Reals(table[slot]).at[index] : otherwise;
}

void main() {
  ivec2 here = ivec2(gl_GlobalInvocationID.xy);
  if (here.x >= C.width || here.y >= C.height) return;
  int k = here.y * C.width + here.x, index = here.y * C.stride + here.x;
  if (C.to_image == 0) {
    vec4 v = texel(k);
    if (C.role == kNormalRole) {
      vec3 n = C.format == kBytes4 || C.format == kBytes4Swapped ? v.xyz * 2.0f - 1.0f : v.xyz;
      v.x = C.rotation[0] * n.x + C.rotation[1] * n.y + C.rotation[2] * n.z;
      v.y = C.rotation[3] * n.x + C.rotation[4] * n.y + C.rotation[5] * n.z;
      v.z = C.rotation[6] * n.x + C.rotation[7] * n.y + C.rotation[8] * n.z;
    } else if (C.role != kPlainRole) {
      v.x = view_depth(v.x, here);
    }
    for (int c = 0; c < 4; ++c) store(1 + c, index, v[c]);
    return;
  }
  vec4 v = vec4(load(1, index, 0.0f), load(2, index, 0.0f), load(3, index, 0.0f), load(4, index, 1.0f));
  Words to = Words(table[0]);
  if (C.format == kFloat1) {
    to.at[k] = floatBitsToUint(v.x);
  } else if (C.format == kFloat4) {
    for (int c = 0; c < 4; ++c) to.at[4 * k + c] = floatBitsToUint(v[c]);
  } else if (C.format == kHalf4) {
    to.at[2 * k] = packHalf2x16(v.xy);
    to.at[2 * k + 1] = packHalf2x16(v.zw);
  } else {
    v = clamp(v, 0.0f, 1.0f);
    if (C.srgb != 0) v.rgb = srgb_from_linear(v.rgb);
    to.at[k] = packUnorm4x8(C.format == kBytes4Swapped ? v.bgra : v);
  }
}
