// The dialect of kernel texts as GLSL. A NAME.comp includes this, its constants, and then
//   UMBRAGE_CONSTANTS(NameConstants)
//   #include "machine/common.kernel.h"
//   #include "effects/NAME/NAME.kernel.h"
//   UMBRAGE_MAIN(NAME)
// Bindings are given out by the compiler (glslc -fauto-bind-uniforms) and found by name: NAME_block.
#extension GL_EXT_scalar_block_layout : require
#define Real float
#define Int int
#define Uint uint
#define Bool bool
#define Vec2 vec2
#define Vec3 vec3
#define FN
#define CONST const
#define mad fma
#define rsqrt inversesqrt
#define to_int int
#define to_uint uint
#define to_signed int
#define to_real float
#define popcount bitCount
#define some(mask) (mask)
#define select(mask, a, b) ((mask) ? (a) : (b))
#define pow(a, b) pow_of(a, b)
#include "machine/frame_constants.h"

layout(local_size_x = 8, local_size_y = 8) in;
ivec2 here;

float pow_of(float a, float b) { return a > 0.0f ? exp2(b * log2(a)) : 0.0f; }
uint ones_from(int b) { return b < 32 ? 0xffffffffu << b : 0u; }
bool is_finite(float a) { return abs(a) <= 3.402823466e38f; }

#define UMBRAGE_CONSTANTS(Constants)                                                                     \
  layout(scalar) readonly buffer constants_block {                                                       \
    FrameConstants F;                                                                                    \
    Constants C;                                                                                         \
  };                                                                                                     \
  int index_of(int X, int Y) { return clamp(Y, 0, F.height - 1) * F.stride + clamp(X, 0, F.width - 1); } \
  bool near_inside(int i, int j) {                                                                       \
    return here.x + i >= 0 && here.x + i < F.width && here.y + j >= 0 && here.y + j < F.height;          \
  }

#define IN_REAL(name)                                                                                          \
  layout(scalar) readonly buffer name##_block { float name##_plane[]; };                                       \
  float load_##name(int X, int Y) { return name##_plane[index_of(X, Y)]; }                                     \
  float near_##name(int i, int j) { return name##_plane[index_of(here.x + i, here.y + j)]; }                   \
  float corner_##name(int f, int i, int j) { return load_##name((here.x / f + i) * f, (here.y / f + j) * f); } \
  float block_##name(int f, int i, int j) { return load_##name(here.x / f + i, here.y / f + j); }
#define IN_TRIPLE(name, a, b, c)                                                                              \
  layout(scalar) readonly buffer name##_##a##_block { float name##_plane_0[]; };                              \
  layout(scalar) readonly buffer name##_##b##_block { float name##_plane_1[]; };                              \
  layout(scalar) readonly buffer name##_##c##_block { float name##_plane_2[]; };                              \
  vec3 load_##name(int X, int Y) {                                                                            \
    int k = index_of(X, Y);                                                                                   \
    return vec3(name##_plane_0[k], name##_plane_1[k], name##_plane_2[k]);                                     \
  }                                                                                                           \
  vec3 near_##name(int i, int j) { return load_##name(here.x + i, here.y + j); }                              \
  vec3 corner_##name(int f, int i, int j) { return load_##name((here.x / f + i) * f, (here.y / f + j) * f); } \
  vec3 block_##name(int f, int i, int j) { return load_##name(here.x / f + i, here.y / f + j); }
#define IN_VECTOR(name) IN_TRIPLE(name, x, y, z)
#define IN_COLOR(name) IN_TRIPLE(name, r, g, b)
// A plane of every layer: load_NAME_of(layer, X, Y), layer the same for all pixels.
#define OF_LAYERS(type, name)                      \
  type load_##name##_of(int layer, int X, int Y) { \
    switch (layer) {                               \
      case 0:                                      \
        return load_##name(X, Y);                  \
      case 1:                                      \
        return load_layer1_##name(X, Y);           \
      case 2:                                      \
        return load_layer2_##name(X, Y);           \
      case 3:                                      \
        return load_layer3_##name(X, Y);           \
      case 4:                                      \
        return load_layer4_##name(X, Y);           \
      case 5:                                      \
        return load_layer5_##name(X, Y);           \
      case 6:                                      \
        return load_layer6_##name(X, Y);           \
      default:                                     \
        return load_layer7_##name(X, Y);           \
    }                                              \
  }
#define IN_LAYERS_REAL(name) \
  IN_REAL(name)              \
  IN_REAL(layer1_##name)     \
  IN_REAL(layer2_##name)     \
  IN_REAL(layer3_##name)     \
  IN_REAL(layer4_##name)     \
  IN_REAL(layer5_##name)     \
  IN_REAL(layer6_##name)     \
  IN_REAL(layer7_##name)     \
  OF_LAYERS(float, name)
#define IN_LAYERS_VECTOR(name) \
  IN_VECTOR(name)              \
  IN_VECTOR(layer1_##name)     \
  IN_VECTOR(layer2_##name)     \
  IN_VECTOR(layer3_##name)     \
  IN_VECTOR(layer4_##name)     \
  IN_VECTOR(layer5_##name)     \
  IN_VECTOR(layer6_##name)     \
  IN_VECTOR(layer7_##name)     \
  OF_LAYERS(vec3, name)
#define IN_LAYERS_COLOR(name) \
  IN_COLOR(name)              \
  IN_COLOR(layer1_##name)     \
  IN_COLOR(layer2_##name)     \
  IN_COLOR(layer3_##name)     \
  IN_COLOR(layer4_##name)     \
  IN_COLOR(layer5_##name)     \
  IN_COLOR(layer6_##name)     \
  IN_COLOR(layer7_##name)     \
  OF_LAYERS(vec3, name)
#define OUT_REAL(name)                                                    \
  layout(scalar) writeonly buffer name##_block { float name##_plane[]; }; \
  void store_##name(float v) { name##_plane[here.y * F.stride + here.x] = v; }
#define OUT_ALPHA(name)                                                       \
  layout(scalar) writeonly buffer name##_a_block { float name##_plane_3[]; }; \
  void store_##name##_alpha(float v) { name##_plane_3[here.y * F.stride + here.x] = v; }
#define OUT_TRIPLE(name, a, b, c)                                                 \
  layout(scalar) writeonly buffer name##_##a##_block { float name##_plane_0[]; }; \
  layout(scalar) writeonly buffer name##_##b##_block { float name##_plane_1[]; }; \
  layout(scalar) writeonly buffer name##_##c##_block { float name##_plane_2[]; }; \
  void store_##name(vec3 v) {                                                     \
    int k = here.y * F.stride + here.x;                                           \
    name##_plane_0[k] = v.x;                                                      \
    name##_plane_1[k] = v.y;                                                      \
    name##_plane_2[k] = v.z;                                                      \
  }
#define INOUT_COLOR(name)                                                 \
  layout(scalar) buffer name##_r_block { float name##_plane_0[]; };       \
  layout(scalar) buffer name##_g_block { float name##_plane_1[]; };       \
  layout(scalar) buffer name##_b_block { float name##_plane_2[]; };       \
  vec3 own_##name() {                                                     \
    int k = here.y * F.stride + here.x;                                   \
    return vec3(name##_plane_0[k], name##_plane_1[k], name##_plane_2[k]); \
  }                                                                       \
  void store_##name(vec3 v) {                                             \
    int k = here.y * F.stride + here.x;                                   \
    name##_plane_0[k] = v.x;                                              \
    name##_plane_1[k] = v.y;                                              \
    name##_plane_2[k] = v.z;                                              \
  }
#define OUT_VECTOR(name) OUT_TRIPLE(name, x, y, z)
#define OUT_COLOR(name) OUT_TRIPLE(name, r, g, b)

#define UMBRAGE_MAIN(name)                               \
  void main() {                                          \
    here = ivec2(gl_GlobalInvocationID.xy);              \
    if (here.x >= F.width || here.y >= F.height) return; \
    name##_pixel(here.x, here.y);                        \
  }
