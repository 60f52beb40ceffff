// Code shared by ray tracing and rasterisation of a scene (capture.comp, corner.vert, peel.frag): access to its data,
// texture filtering, and the intersection of rays with triangles and points.
#ifndef UMBRAGE_DEVICES_VULKAN_CAPTURE_SCENE_GLSL
#define UMBRAGE_DEVICES_VULKAN_CAPTURE_SCENE_GLSL
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#include "devices/vulkan/capture.h"
#include "kernel/frame_constants.h"

layout(set = 0, binding = 0, scalar) uniform constants_block { CaptureConstants C; };
layout(set = 0, binding = 1, scalar) uniform table_block { uvec2 table[kMaxPlanes]; };

layout(buffer_reference, scalar, buffer_reference_align = 4) restrict readonly buffer Floats { float at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) restrict readonly buffer Uints { uint at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 16) restrict readonly buffer Vectors { vec4 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) restrict readonly buffer Meshes { CaptureMesh at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) restrict readonly buffer Textures { CaptureTexture at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) restrict readonly buffer Levels { CaptureLevel at[]; };

const float kInfinity = 1.0f / 0.0f;
const float kLayerStep = 1e-5f;  // as in devices/cpu/capture.cpp
// Relative tolerance of edges: the border of a triangle belongs to it, as in Embree.
const float kEdgeRounding = 1.1920929e-7f;
const int kMaxTaps = 8;  // as in rays/mip_texture.cpp

vec3 to_vec3(float v[3]) { return vec3(v[0], v[1], v[2]); }
float max_component(vec3 v) { return max(max(v.x, v.y), v.z); }

// ---- textures ----

float linear_from_srgb(uint byte) { return Floats(table[kPointsSlot]).at[32 * (kCaptureDiscPoints + 1) + int(byte)]; }

vec4 texel(CaptureLevel level, bool linear, int x, int y) {
  uint v = Uints(table[kTexelsSlot]).at[level.first_texel + y * level.width + x];
  if (linear) return unpackUnorm4x8(v);
  return vec4(linear_from_srgb(v & 255u), linear_from_srgb((v >> 8) & 255u), linear_from_srgb((v >> 16) & 255u),
              float(v >> 24) * (1.0f / 255.0f));
}

float fraction_of(float x) { return abs(x) < 8388608.0f ? x - floor(x) : 0.0f; }

vec2 wrapped(CaptureLevel level, vec2 uv) {
  return level.clamped != 0 ? vec2(uv.x, 1.0f - uv.y) : vec2(fraction_of(uv.x), 1.0f - fraction_of(uv.y));
}

// Returns the two texels next to a coordinate along one side of a texture. `between`: its position between their
// centres, from 0 to 1.
void neighbours(float coordinate, int size, bool clamped, out int low, out int high, out float between) {
  float x = coordinate * float(size) - 0.5f;
  if (clamped) x = min(max(0.0f, x), float(size - 1));
  float whole = floor(x);
  between = x - whole;
  low = min(int(whole), size - 1);
  high = low + 1 >= size ? 0 : low + 1;
  low = low < 0 ? size - 1 : low;
}

vec4 bilinear(CaptureLevel level, bool linear, vec2 coordinate) {
  int x0, x1, y0, y1;
  float fx, fy;
  neighbours(coordinate.x, level.width, level.clamped != 0, x0, x1, fx);
  neighbours(coordinate.y, level.height, level.clamped != 0, y0, y1, fy);
  if (level.nearest != 0) fx = step(0.5f, fx), fy = step(0.5f, fy);
  return mix(mix(texel(level, linear, x0, y0), texel(level, linear, x1, y0), fx),
             mix(texel(level, linear, x0, y1), texel(level, linear, x1, y1), fx), fy);
}

vec4 sample_filtered(int index, vec2 uv, vec2 right, vec2 down) {
  CaptureTexture image = Textures(table[kTexturesSlot]).at[index];
  Levels levels = Levels(table[kLevelsSlot]);
  vec2 size = vec2(levels.at[image.first_level].width, levels.at[image.first_level].height);
  float across = length(right * size), along = length(down * size);
  float longer = max(across, along), shorter = min(across, along);
  vec2 axis = along > across ? down : right;
  int last = image.levels - 1, taps = 1, fine = last;
  float blend = 0.0f;
  if (longer <= 3.402823466e38f) {
    float ratio = clamp(longer / max(shorter, 1e-6f), 1.0f, longer > 1.0f ? float(kMaxTaps) : 1.0f);
    taps = int(ratio + 0.5f);
    float width = max(longer / float(taps), 1.0f);
    float lod = width > 1.0f ? clamp(log2(width), 0.0f, float(last)) : 0.0f;
    fine = int(lod);
    blend = lod - float(fine);
  }
  bool linear = image.linear != 0;
  vec4 sum = vec4(0.0f);
  for (int i = 0; i < taps; ++i) {
    vec2 at = wrapped(levels.at[image.first_level],
                      taps > 1 ? uv + axis * ((float(i) + 0.5f) / float(taps) - 0.5f) : uv);
    vec4 color = bilinear(levels.at[image.first_level + fine], linear, at);
    if (blend > 0.0f) color = mix(color, bilinear(levels.at[image.first_level + fine + 1], linear, at), blend);
    sum += color;
  }
  return sum / float(taps);
}

// Returns the bilinear alpha of the finest level.
float sample_alpha(int index, vec2 uv) {
  CaptureTexture image = Textures(table[kTexturesSlot]).at[index];
  CaptureLevel level = Levels(table[kLevelsSlot]).at[image.first_level];
  return bilinear(level, image.linear != 0, wrapped(level, uv)).a;
}

// ---- triangles ----

// Four vectors: the three corners, with the mesh, the corners' indices and the kind in the last components. For a
// point, p0 is the centre, p1 the normal of a disc, p2.x the radius; p2.y, p2.z and bend are the change of a disc's
// normal (Mesh::bends).
struct Triangle {
  vec3 p0, p1, p2;
  int mesh;
  ivec3 corner;
  int kind;
  float bend;
};

Triangle triangle_at(int k) {
  Vectors from = Vectors(table[kTrianglesSlot]);
  vec4 a = from.at[4 * k], b = from.at[4 * k + 1], c = from.at[4 * k + 2], d = from.at[4 * k + 3];
  return Triangle(a.xyz, b.xyz, c.xyz, floatBitsToInt(a.w),
                  ivec3(floatBitsToInt(b.w), floatBitsToInt(c.w), floatBitsToInt(d.x)), floatBitsToInt(d.y), d.z);
}

vec3 normal_at(int corner) {
  Floats from = Floats(table[kNormalsSlot]);
  return vec3(from.at[3 * corner], from.at[3 * corner + 1], from.at[3 * corner + 2]);
}

vec2 uv_at(int corner) {
  Floats from = Floats(table[kUvsSlot]);
  return vec2(from.at[2 * corner], from.at[2 * corner + 1]);
}

// ---- rays ----

void disc_axes(vec3 direction, out vec3 right, out vec3 up) {
  vec3 axis = normalize(direction);
  right = normalize(cross(axis, abs(axis.x) < 0.7f ? vec3(1.0f, 0.0f, 0.0f) : vec3(0.0f, 1.0f, 0.0f)));
  up = cross(right, axis);
}

struct Ray {
  vec3 origin, direction;
  float nearest, farthest;
};

struct Hit {
  float t, u, v;  // u, v: weights of the second and third corner
  int triangle;   // < 0: none
};

// Returns the alpha of the mesh's texture; 1 if it has none.
float alpha_at(CaptureMesh mesh, Triangle triangle, float u, float v) {
  if (mesh.texture_index < 0) return 1.0f;
  vec2 uv = uv_at(triangle.corner.x) * (1.0f - u - v) + uv_at(triangle.corner.y) * u + uv_at(triangle.corner.z) * v;
  return sample_alpha(mesh.texture_index, uv);
}

// Returns whether a ray passes through the surface there: `min_opacity` is that of the ray.
bool is_cut_out(Triangle triangle, float u, float v, float min_opacity) {
  CaptureMesh mesh = Meshes(table[kMeshesSlot]).at[triangle.mesh];
  if (mesh.masked == 0) return false;
  float alpha = alpha_at(mesh, triangle, u, v);
  return mesh.masked == kBlended ? alpha * mesh.opacity < min_opacity : alpha < mesh.cutoff;
}

// Returns whether the ray meets a disc, or a sphere from either side, before `hit`, and if so replaces `hit`.
bool meets_point(Ray ray, Triangle point, int k, inout Hit hit) {
  vec3 to_center = point.p0 - ray.origin;
  float radius = point.p2.x, t;
  if (point.kind == kDisc) {
    t = dot(to_center, point.p1) / dot(ray.direction, point.p1);
    vec3 away = ray.direction * t - to_center;
    if (!(dot(away, away) < radius * radius)) return false;
  } else {
    float along = dot(ray.direction, ray.direction), nearest = dot(to_center, ray.direction) / along;
    vec3 away = ray.direction * nearest - to_center;
    float inside = radius * radius - dot(away, away);
    if (!(inside >= 0.0f)) return false;
    float half_chord = sqrt(inside / along);
    t = nearest - half_chord > ray.nearest ? nearest - half_chord : nearest + half_chord;
  }
  if (!(t > ray.nearest && t < hit.t)) return false;
  hit = Hit(t, 0.0f, 0.0f, k);
  return true;
}

// Intersection of a ray and a triangle's plane, by signed volumes of the edges, which two triangles that share an edge
// compute identically, so that no ray passes between them [Shoemake 1998].
struct Crossing {
  float t, u, v, w, sum;  // u, v, w: signed volumes; sum: their sum
  bool inside;
};

Crossing crossing_of(Ray ray, Triangle triangle) {
  vec3 v0 = triangle.p0 - ray.origin, v1 = triangle.p1 - ray.origin, v2 = triangle.p2 - ray.origin;
  vec3 e0 = v2 - v0, e1 = v0 - v1, e2 = v1 - v2;
  precise float u = dot(cross(e0, v2 + v0), ray.direction);
  precise float v = dot(cross(e1, v0 + v1), ray.direction);
  precise float w = dot(cross(e2, v1 + v2), ray.direction);
  float sum = u + v + w;
  float rounding = kEdgeRounding * abs(sum);
  bool inside = !(min(min(u, v), w) < -rounding && max(max(u, v), w) > rounding) && sum != 0.0f;
  vec3 across = cross(e0, e1);
  return Crossing(dot(v0, across) / dot(across, ray.direction), u, v, w, sum, inside);
}

// ---- pixels ----

mat3 view_rotation() {
  return transpose(mat3(C.to_view[0], C.to_view[1], C.to_view[2], C.to_view[3], C.to_view[4], C.to_view[5],
                        C.to_view[6], C.to_view[7], C.to_view[8]));
}

vec3 origin_at(vec2 p) { return to_vec3(C.origin) + to_vec3(C.origin_x) * p.x + to_vec3(C.origin_y) * p.y; }
vec3 direction_at(vec2 p) { return to_vec3(C.direction) + to_vec3(C.direction_x) * p.x + to_vec3(C.direction_y) * p.y; }

// Computes the ray through a pixel's centre, which starts behind the previous layer. Returns false if the previous
// layer shows background there.
bool pixel_ray(ivec2 here, out Ray ray) {
  vec2 pixel = vec2(here) + 0.5f;
  ray = Ray(origin_at(pixel), direction_at(pixel), 0.0f, kInfinity);
  uvec2 previous = table[kPreviousDepthSlot];
  if ((previous.x | previous.y) == 0u) return true;
  float depth = Floats(previous).at[here.y * C.stride + here.x];
  vec3 hit = ray.origin + ray.direction * depth;
  ray.nearest = depth + kLayerStep * (length(hit) + distance(hit, to_vec3(C.eye))) / length(ray.direction);
  return depth < kInfinity;
}

// Returns the hit of a pixel's ray with a triangle that covers the pixel. Rasterisation decides coverage, so on the
// triangle's border the ray may miss it slightly. Then the hit is where the ray meets the triangle's plane, with depth
// and weights clamped to those of the triangle.
Hit hit_of_covered_triangle(Ray ray, Triangle triangle, int k) {
  Crossing at = crossing_of(ray, triangle);
  float side = at.sum < 0.0f ? -1.0f : 1.0f;
  vec3 weights = max(side * vec3(at.u, at.v, at.w), 0.0f);
  float sum = weights.x + weights.y + weights.z;
  weights = sum > 0.0f ? weights / sum : vec3(1.0f / 3.0f);
  float t = at.t;
  if (!at.inside) {
    vec3 row = to_vec3(C.clip_w), origin = to_vec3(C.origin);
    vec3 depths = vec3(dot(triangle.p0 - origin, row), dot(triangle.p1 - origin, row), dot(triangle.p2 - origin, row));
    float low = min(min(depths.x, depths.y), depths.z), high = max(max(depths.x, depths.y), depths.z);
    t = t > low ? (t < high ? t : high) : low;
  }
  return Hit(t, weights.x, weights.y, k);
}

// Returns the hit of a pixel's ray with a triangle or point whose rasterised shape covers the pixel; the ray may miss a
// point.
Hit hit_of_covered(Ray ray, Triangle triangle, int k) {
  if (triangle.kind == kTriangle) return hit_of_covered_triangle(ray, triangle, k);
  Hit hit = Hit(kInfinity, 0.0f, 0.0f, -1);
  meets_point(ray, triangle, k, hit);
  return hit;
}

#endif
