// The kernel dialect for graphics APIs in which planes are textures: GLSL and GLSL ES 3.00 fragment shaders.
// Counterpart of glsl.h. `umbrage shaders` writes one shader per dispatch from it (kit/shader_text.h). It expands the
// macros of planes once per plane, with line breaks, and leaves out functions that the kernel does not call.
//
// A plane is the texture NAME_texture: one channel, or three of a vector or colour, with alpha in the fourth. An output
// is NAME_out. A plane that a kernel reads and writes is both. A texture of one pixel stands for a constant plane.
// F is the uniform block of what depends on the view, C the settings. There is one depth layer. A place is the column
// and the row of a pixel, 16 bits each.
//
// Differences from the other targets: without FMA, mul_add rounds twice; the depth of the background is 0 in textures,
// and kFar in the shader, since GLSL ES guarantees no infinities.

const int kLanes = 1;
const int kListLength = 8;

// The depth of the background, and the bound of what is finite: distances computed from that depth are above it.
const float kFar = 3e38;
const float kMaxFinite = 1e30;

// The pixel that is computed: column and row, from the top left corner.
ivec2 here;

// Returns whether a value is neither NaN nor infinite, nor computed from the depth of the background.
bool is_finite(float a) { return abs(a) < kMaxFinite; }

// Returns a b + c, rounded once where the GPU can.
float mul_add(float a, float b, float c) { return fma(a, b, c); }

// Return a where the condition holds, otherwise b.
float select(bool condition, float a, float b) { return condition ? a : b; }
int select(bool condition, int a, int b) { return condition ? a : b; }
uint select(bool condition, uint a, uint b) { return condition ? a : b; }
vec2 select(bool condition, vec2 a, vec2 b) { return condition ? a : b; }
vec3 select(bool condition, vec3 a, vec3 b) { return condition ? a : b; }

// Returns a^b, and 0 if a is not above 0.
float power(float a, float b) { return a > 0.0 ? exp2(b * log2(a)) : 0.0; }

// Returns the 32 bits from bit b on.
uint ones_from(int b) { return b < 32 ? 0xffffffffu << b : 0u; }

// Returns the number of bits that are set.
int count_bits(uint v) {
  v = v - ((v >> 1) & 0x55555555u);
  v = (v & 0x33333333u) + ((v >> 2) & 0x33333333u);
  return int((((v + (v >> 4)) & 0x0f0f0f0fu) * 0x01010101u) >> 24);
}

// Returns the place of a pixel. x and y are integers.
int place_of(float x, float y) { return (int(y) << 16) | int(x); }

// Returns whether the pixel (i, j) to the right and below is inside the picture.
bool near_inside(int i, int j) {
  return here.x + i >= 0 && here.x + i < F.width && here.y + j >= 0 && here.y + j < F.height;
}

// Returns the texel of a pixel, counted from the top left corner; outside the texture that of the nearest pixel inside.
ivec2 texel_of(ivec2 pixel, ivec2 size) {
  pixel = clamp(pixel, ivec2(0), size - 1);
  return ROW_0_AT_TOP ? pixel : ivec2(pixel.x, size.y - 1 - pixel.y);
}

// Returns the unit vector that a texture of normals holds. UMBRAGE_NORMALS 0: the vector; 1: from -1 to 1 as 0 to 1;
// 2: octahedral [Cigolle et al. 2014] in two channels, 0 to 1. (0, 0, 0), or 0 in all channels, stays 0: background.
vec3 decoded_normal(vec4 texel) {
  if (UMBRAGE_NORMALS == 0 || texel.rgb == vec3(0.0)) return texel.rgb;
  if (UMBRAGE_NORMALS == 1) return normalize(texel.rgb * 2.0 - 1.0);
  vec2 at = texel.rg * 2.0 - 1.0;
  vec3 n = vec3(at, 1.0 - abs(at.x) - abs(at.y));
  float folded = max(-n.z, 0.0);
  n.x = n.x - (n.x < 0.0 ? -folded : folded);
  n.y = n.y - (n.y < 0.0 ? -folded : folded);
  return normalize(n);
}

#define IN_PLANE(type, name, fetched)                                                           \
  uniform highp sampler2D name_texture;                                                         \
  type texel_of_name(ivec2 pixel) {                                                             \
    vec4 texel = texelFetch(name_texture, texel_of(pixel, textureSize(name_texture, 0)), 0);    \
    return fetched;                                                                             \
  }                                                                                             \
  type read_name(int place) { return texel_of_name(ivec2(place & 0xffff, place >> 16)); }       \
  type read_name_of(int layer, int place) { return read_name(place); }                          \
  type load_name(int x, int y) { return texel_of_name(ivec2(x, y)); }                           \
  type near_name(int i, int j) { return texel_of_name(here + ivec2(i, j)); }                    \
  type near_name_of(int layer, int i, int j) { return near_name(i, j); }                        \
  type own_name() { return texel_of_name(here); }                                               \
  type corner_name(int f, int i, int j) { return texel_of_name((here / f + ivec2(i, j)) * f); } \
  type block_name(int f, int i, int j) { return texel_of_name(here / f + ivec2(i, j)); }

#define OUT_PLANE(type, name, set)                                 \
  layout(location = name_location) out highp name_format name_out; \
  void store_name(type v) { set; }                                 \
  void store_name_of(int layer, type v) { store_name(v); }         \
  void store_name_alpha(float v) { name_out.a = v; }

// The text uses at most one list and one sum per shader thread.
#define LIST_PLANE(type, name, length)                      \
  type name_list[length];                                   \
  void keep_name(int slot, type v) { name_list[slot] = v; } \
  type kept_name(int slot) { return name_list[slot]; }      \
  void append_name(int at, bool where, type v) {            \
    if (where) name_list[at] = v;                           \
  }                                                         \
  type entries_name(int at) { return name_list[at]; }

#define SUMS_PLANE(type, name, length)                  \
  vec3 name_sum;                                        \
  void clear_name() { name_sum = vec3(0.0); }           \
  void add_to_name(int lane, vec3 v) { name_sum += v; } \
  vec3 sum_of_name() { return name_sum; }
