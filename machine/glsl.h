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
#define bits_of floatBitsToUint
#define real_of_bits uintBitsToFloat
#define popcount bitCount
#define some(mask) (mask)
#define how_many(mask) ((mask) ? 1 : 0)
#define this_lane() 0
#define of_lane(v, lane) (v)
#define select(mask, a, b) ((mask) ? (a) : (b))
#define pow(a, b) pow_of(a, b)
#include "machine/frame_constants.h"

layout(local_size_x = 8, local_size_y = 8) in;
ivec2 here;
const int kLanes = 1;
const int kListLength = 8;  // a GPU keeps a list where it keeps what registers cannot hold

float pow_of(float a, float b) { return a > 0.0f ? exp2(b * log2(a)) : 0.0f; }
uint ones_from(int b) { return b < 32 ? 0xffffffffu << b : 0u; }
bool is_finite(float a) { return abs(a) <= 3.402823466e38f; }

#define UMBRAGE_CONSTANTS(Constants)                                                                     \
  layout(scalar) readonly buffer constants_block {                                                       \
    FrameConstants F;                                                                                    \
    Constants C;                                                                                         \
  };                                                                                                     \
  int index_of(int X, int Y) { return clamp(Y, 0, F.height - 1) * F.stride + clamp(X, 0, F.width - 1); } \
  int place_of(float X, float Y) { return int(Y) * F.stride + int(X); }                                  \
  bool near_inside(int i, int j) {                                                                       \
    return here.x + i >= 0 && here.x + i < F.width && here.y + j >= 0 && here.y + j < F.height;          \
  }

#define IN_REAL(name)                                                                                          \
  layout(scalar) readonly buffer name##_block { float name##_plane[]; };                                       \
  float load_##name(int X, int Y) { return name##_plane[index_of(X, Y)]; }                                     \
  float read_##name(int place) { return name##_plane[place]; }                                                 \
  float near_##name(int i, int j) { return name##_plane[index_of(here.x + i, here.y + j)]; }                   \
  float corner_##name(int f, int i, int j) { return load_##name((here.x / f + i) * f, (here.y / f + j) * f); } \
  float block_##name(int f, int i, int j) { return load_##name(here.x / f + i, here.y / f + j); }
#define IN_TRIPLE(name, a, b, c)                                                                                    \
  layout(scalar) readonly buffer name##_##a##_block { float name##_plane_0[]; };                                    \
  layout(scalar) readonly buffer name##_##b##_block { float name##_plane_1[]; };                                    \
  layout(scalar) readonly buffer name##_##c##_block { float name##_plane_2[]; };                                    \
  vec3 load_##name(int X, int Y) {                                                                                  \
    int k = index_of(X, Y);                                                                                         \
    return vec3(name##_plane_0[k], name##_plane_1[k], name##_plane_2[k]);                                           \
  }                                                                                                                 \
  vec3 read_##name(int place) { return vec3(name##_plane_0[place], name##_plane_1[place], name##_plane_2[place]); } \
  vec3 near_##name(int i, int j) { return load_##name(here.x + i, here.y + j); }                                    \
  vec3 corner_##name(int f, int i, int j) { return load_##name((here.x / f + i) * f, (here.y / f + j) * f); }       \
  vec3 block_##name(int f, int i, int j) { return load_##name(here.x / f + i, here.y / f + j); }
#define IN_VECTOR(name) IN_TRIPLE(name, x, y, z)
#define IN_COLOR(name) IN_TRIPLE(name, r, g, b)
// A plane of every layer: read_NAME_of(layer, place), layer the same for all pixels.
#define OF_LAYERS(type, name)                   \
  type read_##name##_of(int layer, int place) { \
    switch (layer) {                            \
      case 0:                                   \
        return read_##name(place);              \
      case 1:                                   \
        return read_layer1_##name(place);       \
      case 2:                                   \
        return read_layer2_##name(place);       \
      case 3:                                   \
        return read_layer3_##name(place);       \
      case 4:                                   \
        return read_layer4_##name(place);       \
      case 5:                                   \
        return read_layer5_##name(place);       \
      case 6:                                   \
        return read_layer6_##name(place);       \
      default:                                  \
        return read_layer7_##name(place);       \
    }                                           \
  }
#define NEAR_LAYERS(type, name) \
  type near_##name##_of(int layer, int i, int j) { return read_##name##_of(layer, index_of(here.x + i, here.y + j)); }
#define IN_LAYERS_REAL(name) \
  IN_REAL(name)              \
  IN_REAL(layer1_##name)     \
  IN_REAL(layer2_##name)     \
  IN_REAL(layer3_##name)     \
  IN_REAL(layer4_##name)     \
  IN_REAL(layer5_##name)     \
  IN_REAL(layer6_##name)     \
  IN_REAL(layer7_##name)     \
  OF_LAYERS(float, name)     \
  NEAR_LAYERS(float, name)
#define IN_LAYERS_VECTOR(name) \
  IN_VECTOR(name)              \
  IN_VECTOR(layer1_##name)     \
  IN_VECTOR(layer2_##name)     \
  IN_VECTOR(layer3_##name)     \
  IN_VECTOR(layer4_##name)     \
  IN_VECTOR(layer5_##name)     \
  IN_VECTOR(layer6_##name)     \
  IN_VECTOR(layer7_##name)     \
  OF_LAYERS(vec3, name)        \
  NEAR_LAYERS(vec3, name)
#define IN_LAYERS_COLOR(name) \
  IN_COLOR(name)              \
  IN_COLOR(layer1_##name)     \
  IN_COLOR(layer2_##name)     \
  IN_COLOR(layer3_##name)     \
  IN_COLOR(layer4_##name)     \
  IN_COLOR(layer5_##name)     \
  IN_COLOR(layer6_##name)     \
  IN_COLOR(layer7_##name)     \
  OF_LAYERS(vec3, name)       \
  NEAR_LAYERS(vec3, name)
#define LIST(type, name, length)                                \
  type name##_list[length];                                     \
  void keep_##name(int slot, type v) { name##_list[slot] = v; } \
  type kept_##name(int slot) { return name##_list[slot]; }      \
  void append_##name(int at, bool where, type v) {              \
    if (where) name##_list[at] = v;                             \
  }                                                             \
  type entries_##name(int at) { return name##_list[at]; }
#define SUMS(name)                                          \
  vec3 name##_sum;                                          \
  void clear_##name() { name##_sum = vec3(0.0f); }          \
  void add_to_##name(int lane, vec3 v) { name##_sum += v; } \
  vec3 sum_of_##name() { return name##_sum; }
#define LIST_REAL(name, length) LIST(float, name, length)
#define LIST_UINT(name, length) LIST(uint, name, length)
#define OUT_REAL(name)                                                    \
  layout(scalar) writeonly buffer name##_block { float name##_plane[]; }; \
  void store_##name(float v) { name##_plane[here.y * F.stride + here.x] = v; }
#define OUT_LAYERS_REAL(name)                  \
  OUT_REAL(name)                               \
  OUT_REAL(layer1_##name)                      \
  OUT_REAL(layer2_##name)                      \
  OUT_REAL(layer3_##name)                      \
  OUT_REAL(layer4_##name)                      \
  OUT_REAL(layer5_##name)                      \
  OUT_REAL(layer6_##name)                      \
  OUT_REAL(layer7_##name)                      \
  void store_##name##_of(int layer, float v) { \
    if (layer == 0) store_##name(v);           \
    if (layer == 1) store_layer1_##name(v);    \
    if (layer == 2) store_layer2_##name(v);    \
    if (layer == 3) store_layer3_##name(v);    \
    if (layer == 4) store_layer4_##name(v);    \
    if (layer == 5) store_layer5_##name(v);    \
    if (layer == 6) store_layer6_##name(v);    \
    if (layer == 7) store_layer7_##name(v);    \
  }
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
#define INOUT_REAL(name)                                                  \
  layout(scalar) buffer name##_block { float name##_plane[]; };           \
  float own_##name() { return name##_plane[here.y * F.stride + here.x]; } \
  void store_##name(float v) { name##_plane[here.y * F.stride + here.x] = v; }
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
