// The kernel dialect in GLSL. A shader includes this file and the header of its constants, and then contains
//   UMBRAGE_CONSTANTS(NameConstants)
//   #include "kernel/common.kernel.h"
//   #include "effects/NAME/NAME.kernel.h"
//   UMBRAGE_MAIN(NAME)
// The build writes such a shader for every kernel (cmake/kernels.cmake).
//
// A dispatch reads up to a hundred planes, more than drivers can bind at once. Its first input planes are bound
// buffers, which are fastest. All other inputs, all outputs, and planes selected by layer number are accessed by their
// addresses in the table `planes`. The device passes the index of a plane in that table as the specialization constant
// NAME_slot. Its id follows from the number that the build gives to each name in plane_ids.h.
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#define Real float
#define Int int
#define Uint uint
#define Bool bool
#define Vec2 vec2
#define Vec3 vec3
#define FN
#define FN_RARE
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
#define count_lanes(mask) ((mask) ? 1 : 0)
#define this_lane() 0
#define lane_value(v, lane) (v)
#define entry_of(array, k) ((array)[k])
#define select(mask, a, b) ((mask) ? (a) : (b))
#define pow(a, b) pow_of(a, b)
#include "kernel/frame_constants.h"
#include "kernels/plane_ids.h"

layout(local_size_x = 8, local_size_y = 8) in;
ivec2 here;
const int kLanes = 1;
const int kListLength = 8;  // a GPU stores lists in the memory for spilled registers

float pow_of(float a, float b) { return a > 0.0f ? exp2(b * log2(a)) : 0.0f; }
uint ones_from(int b) { return b < 32 ? 0xffffffffu << b : 0u; }
bool is_finite(float a) { return abs(a) <= 3.402823466e38f; }

layout(buffer_reference, scalar, buffer_reference_align = 4) restrict readonly buffer InPlane { float at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer OutPlane { float at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer InOutPlane { float at[]; };
// Only for GpuVariant steps:
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer UintPlane { uint at[]; };
layout(set = 0, binding = 1, scalar) uniform planes_block { uvec2 planes[kMaxPlanes]; };

// Number of planes, counted from the first, that are bound buffers; 0 if they are larger than the device can bind.
layout(constant_id = 0) const int bound_planes = 0;
layout(set = 1, binding = 0, scalar) restrict readonly buffer bound_block { float at[]; }
bound[kBoundPlanes];

// The id of plane `n` of those with the name NAME: 0 to 2 are its channels, 3 is alpha, and then come three for each
// further layer.
#define PLANE_ID(name, n) (ID_##name + n)
// Declares NAME_plane(), which returns plane NAME.
#define PLANE_AT(type, name, id)                      \
  layout(constant_id = id) const int name##_slot = 0; \
  type name##_plane() { return type(planes[name##_slot]); }
#define PLANE(type, name) PLANE_AT(type, name, PLANE_ID(name, 0))

#define UMBRAGE_CONSTANTS(Constants)                                                                     \
  layout(set = 0, binding = 0, scalar) uniform constants_block {                                         \
    FrameConstants F;                                                                                    \
    Constants C;                                                                                         \
  };                                                                                                     \
  int index_of(int X, int Y) { return clamp(Y, 0, F.height - 1) * F.stride + clamp(X, 0, F.width - 1); } \
  int index_of_own() { return here.y * F.stride + here.x; }                                              \
  int place_of(float X, float Y) { return int(Y) * F.stride + int(X); }                                  \
  bool near_inside(int i, int j) {                                                                       \
    return here.x + i >= 0 && here.x + i < F.width && here.y + j >= 0 && here.y + j < F.height;          \
  }

#define IN_LOADS(type, name)                                                                                  \
  type load_##name(int X, int Y) { return read_##name(index_of(X, Y)); }                                      \
  type near_##name(int i, int j) { return load_##name(here.x + i, here.y + j); }                              \
  type corner_##name(int f, int i, int j) { return load_##name((here.x / f + i) * f, (here.y / f + j) * f); } \
  type block_##name(int f, int i, int j) { return load_##name(here.x / f + i, here.y / f + j); }
// Defines NAME_at(place), which reads one float of a plane. Whether the plane is bound is known when the shader is
// compiled.
#define READ_AT(name)                                                     \
  const int name##_bound = name##_slot < kBoundPlanes ? name##_slot : 0;  \
  float name##_at(int place) {                                            \
    if (name##_slot < bound_planes) return bound[name##_bound].at[place]; \
    return name##_plane().at[place];                                      \
  }
#define IN_REAL_AT(name, id)                                \
  PLANE_AT(InPlane, name, id)                               \
  READ_AT(name)                                             \
  float read_##name(int place) { return name##_at(place); } \
  IN_LOADS(float, name)
#define IN_TRIPLE_AT(name, id, a, b, c)                                                                                \
  PLANE_AT(InPlane, name##_##a, id)                                                                                    \
  PLANE_AT(InPlane, name##_##b, id + 1)                                                                                \
  PLANE_AT(InPlane, name##_##c, id + 2)                                                                                \
  READ_AT(name##_##a)                                                                                                  \
  READ_AT(name##_##b)                                                                                                  \
  READ_AT(name##_##c)                                                                                                  \
  vec3 read_##name(int place) { return vec3(name##_##a##_at(place), name##_##b##_at(place), name##_##c##_at(place)); } \
  IN_LOADS(vec3, name)
#define IN_REAL(name) IN_REAL_AT(name, PLANE_ID(name, 0))
#define IN_VECTOR(name) IN_TRIPLE_AT(name, PLANE_ID(name, 0), x, y, z)
#define IN_COLOR(name) IN_TRIPLE_AT(name, PLANE_ID(name, 0), r, g, b)
#define IN_ALPHA(name) IN_REAL_AT(name##_a, PLANE_ID(name, 3))
// Defines read_NAME_of(layer, place) for a plane that every layer has. `layer` is the same for all pixels. The code
// selects the plane and then reads once, instead of selecting among values, since lavapipe runs all cases of a switch.
#define SLOT_OF_LAYER(name)                      \
  int name##_slot_of(int layer) {                \
    int slot = name##_slot;                      \
    if (layer == 1) slot = layer1_##name##_slot; \
    if (layer == 2) slot = layer2_##name##_slot; \
    if (layer == 3) slot = layer3_##name##_slot; \
    if (layer == 4) slot = layer4_##name##_slot; \
    if (layer == 5) slot = layer5_##name##_slot; \
    if (layer == 6) slot = layer6_##name##_slot; \
    if (layer == 7) slot = layer7_##name##_slot; \
    return slot;                                 \
  }                                              \
  float read_##name##_of(int layer, int place) { return InPlane(planes[name##_slot_of(layer)]).at[place]; }
#define NEAR_OF_LAYER(type, name) \
  type near_##name##_of(int layer, int i, int j) { return read_##name##_of(layer, index_of(here.x + i, here.y + j)); }
#define IN_LAYERS_REAL(name)                    \
  IN_REAL_AT(name, PLANE_ID(name, 0))           \
  IN_REAL_AT(layer1_##name, PLANE_ID(name, 4))  \
  IN_REAL_AT(layer2_##name, PLANE_ID(name, 7))  \
  IN_REAL_AT(layer3_##name, PLANE_ID(name, 10)) \
  IN_REAL_AT(layer4_##name, PLANE_ID(name, 13)) \
  IN_REAL_AT(layer5_##name, PLANE_ID(name, 16)) \
  IN_REAL_AT(layer6_##name, PLANE_ID(name, 19)) \
  IN_REAL_AT(layer7_##name, PLANE_ID(name, 22)) \
  SLOT_OF_LAYER(name)                           \
  NEAR_OF_LAYER(float, name)
#define IN_LAYERS_TRIPLE(name, a, b, c)                                                     \
  IN_TRIPLE_AT(name, PLANE_ID(name, 0), a, b, c)                                            \
  IN_TRIPLE_AT(layer1_##name, PLANE_ID(name, 4), a, b, c)                                   \
  IN_TRIPLE_AT(layer2_##name, PLANE_ID(name, 7), a, b, c)                                   \
  IN_TRIPLE_AT(layer3_##name, PLANE_ID(name, 10), a, b, c)                                  \
  IN_TRIPLE_AT(layer4_##name, PLANE_ID(name, 13), a, b, c)                                  \
  IN_TRIPLE_AT(layer5_##name, PLANE_ID(name, 16), a, b, c)                                  \
  IN_TRIPLE_AT(layer6_##name, PLANE_ID(name, 19), a, b, c)                                  \
  IN_TRIPLE_AT(layer7_##name, PLANE_ID(name, 22), a, b, c)                                  \
  SLOT_OF_LAYER(name##_##a)                                                                 \
  SLOT_OF_LAYER(name##_##b)                                                                 \
  SLOT_OF_LAYER(name##_##c)                                                                 \
  vec3 read_##name##_of(int layer, int place) {                                             \
    return vec3(read_##name##_##a##_of(layer, place), read_##name##_##b##_of(layer, place), \
                read_##name##_##c##_of(layer, place));                                      \
  }                                                                                         \
  NEAR_OF_LAYER(vec3, name)
#define IN_LAYERS_VECTOR(name) IN_LAYERS_TRIPLE(name, x, y, z)
#define IN_LAYERS_COLOR(name) IN_LAYERS_TRIPLE(name, r, g, b)
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
#define OUT_REAL_AT(type, name, id) \
  PLANE_AT(type, name, id)          \
  void store_##name(float v) { name##_plane().at[index_of_own()] = v; }
#define OUT_REAL(name) OUT_REAL_AT(OutPlane, name, PLANE_ID(name, 0))
#define OUT_LAYERS_REAL(name)                              \
  OUT_REAL_AT(OutPlane, name, PLANE_ID(name, 0))           \
  OUT_REAL_AT(OutPlane, layer1_##name, PLANE_ID(name, 4))  \
  OUT_REAL_AT(OutPlane, layer2_##name, PLANE_ID(name, 7))  \
  OUT_REAL_AT(OutPlane, layer3_##name, PLANE_ID(name, 10)) \
  OUT_REAL_AT(OutPlane, layer4_##name, PLANE_ID(name, 13)) \
  OUT_REAL_AT(OutPlane, layer5_##name, PLANE_ID(name, 16)) \
  OUT_REAL_AT(OutPlane, layer6_##name, PLANE_ID(name, 19)) \
  OUT_REAL_AT(OutPlane, layer7_##name, PLANE_ID(name, 22)) \
  void store_##name##_of(int layer, float v) {             \
    if (layer == 0) store_##name(v);                       \
    if (layer == 1) store_layer1_##name(v);                \
    if (layer == 2) store_layer2_##name(v);                \
    if (layer == 3) store_layer3_##name(v);                \
    if (layer == 4) store_layer4_##name(v);                \
    if (layer == 5) store_layer5_##name(v);                \
    if (layer == 6) store_layer6_##name(v);                \
    if (layer == 7) store_layer7_##name(v);                \
  }
#define OUT_ALPHA(name)                           \
  PLANE_AT(OutPlane, name##_a, PLANE_ID(name, 3)) \
  void store_##name##_alpha(float v) { name##_a_plane().at[index_of_own()] = v; }
#define OUT_TRIPLE(type, name, a, b, c)         \
  PLANE_AT(type, name##_##a, PLANE_ID(name, 0)) \
  PLANE_AT(type, name##_##b, PLANE_ID(name, 1)) \
  PLANE_AT(type, name##_##c, PLANE_ID(name, 2)) \
  void store_##name(vec3 v) {                   \
    int k = index_of_own();                     \
    name##_##a##_plane().at[k] = v.x;           \
    name##_##b##_plane().at[k] = v.y;           \
    name##_##c##_plane().at[k] = v.z;           \
  }
#define INOUT_REAL(name)                           \
  OUT_REAL_AT(InOutPlane, name, PLANE_ID(name, 0)) \
  float own_##name() { return name##_plane().at[index_of_own()]; }
#define INOUT_COLOR(name)                                                                \
  OUT_TRIPLE(InOutPlane, name, r, g, b)                                                  \
  vec3 own_##name() {                                                                    \
    int k = index_of_own();                                                              \
    return vec3(name##_r_plane().at[k], name##_g_plane().at[k], name##_b_plane().at[k]); \
  }
#define OUT_VECTOR(name) OUT_TRIPLE(OutPlane, name, x, y, z)
#define OUT_COLOR(name) OUT_TRIPLE(OutPlane, name, r, g, b)

#define UMBRAGE_MAIN(name)                                                                              \
  void main() {                                                                                         \
    here = ivec2(gl_GlobalInvocationID.xy);                                                             \
    if (here.x >= F.width || here.y >= F.height) return;                                                \
    if (F.missing != 0 && !(InOutPlane(planes[kMaxPlanes - 1]).at[index_of_own()] >= kMissing)) return; \
    name##_pixel(here.x, here.y);                                                                       \
  }
