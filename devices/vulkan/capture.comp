// One depth layer of a scene, traced: what devices/cpu/capture.cpp and rays/ do, for a GPU without the help of its
// driver's own rays. A workgroup is four blocks of 4 x 4 pixels, each of which decides how many rays a soft shadow
// needs.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#include "devices/shared/soften.h"
#include "devices/vulkan/capture.h"
#include "machine/frame_constants.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, scalar) uniform constants_block { CaptureConstants C; };
layout(set = 0, binding = 1, scalar) uniform table_block { uvec2 table[kMostPlanes]; };

layout(buffer_reference, scalar, buffer_reference_align = 4) restrict readonly buffer Floats { float at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) restrict readonly buffer Uints { uint at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 16) restrict readonly buffer Vectors { vec4 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) restrict readonly buffer Meshes { CaptureMesh at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) restrict readonly buffer Textures { CaptureTexture at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) restrict readonly buffer Levels { CaptureLevel at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer OutPlane { float at[]; };

shared int block_pixels[4], block_lit[4];
shared uint block_across[4], block_down[4];  // bits of the narrowest penumbra's radius, squared: ordered as it is

const float kInfinity = 1.0f / 0.0f;
const float kStartOffset = 4e-6f;  // rays/traced_scene.cpp
const float kAboveDisc = 0.3f;     // rays/traced_scene.h
const float kLayerStep = 1e-5f;    // devices/cpu/capture.cpp
const float kEdgeRounding = 1.1920929e-7f;  // of a triangle: its rim belongs to it, as for Embree
const int kMostTaps = 8;           // rays/mip_texture.cpp

vec3 three(float v[3]) { return vec3(v[0], v[1], v[2]); }
vec3 light_vector(float v[3 * kCaptureLights], int k) { return vec3(v[3 * k], v[3 * k + 1], v[3 * k + 2]); }

float largest_of(vec3 v) { return max(max(v.x, v.y), v.z); }

// ---- textures ----

float linear_from_srgb(uint byte) { return Floats(table[kPointsSlot]).at[32 * (kCaptureDiscPoints + 1) + int(byte)]; }

vec4 texel(CaptureLevel level, int x, int y) {
  uint v = Uints(table[kTexelsSlot]).at[level.first_texel + y * level.width + x];
  return vec4(linear_from_srgb(v & 255u), linear_from_srgb((v >> 8) & 255u), linear_from_srgb((v >> 16) & 255u),
              float(v >> 24) * (1.0f / 255.0f));
}

float fraction_of(float x) { return abs(x) < 8388608.0f ? x - floor(x) : 0.0f; }

vec2 within(vec2 uv) { return vec2(fraction_of(uv.x), 1.0f - fraction_of(uv.y)); }

// The two texels around a place along one side, and how far it lies between them.
void neighbours(float share, int size, out int low, out int high, out float between) {
  float x = share * float(size) - 0.5f;
  float whole = floor(x);
  between = x - whole;
  low = min(int(whole), size - 1);
  high = low + 1 >= size ? 0 : low + 1;
  low = low < 0 ? size - 1 : low;
}

vec4 bilinear(CaptureLevel level, vec2 share) {
  int x0, x1, y0, y1;
  float fx, fy;
  neighbours(share.x, level.width, x0, x1, fx);
  neighbours(share.y, level.height, y0, y1, fy);
  return mix(mix(texel(level, x0, y0), texel(level, x1, y0), fx), mix(texel(level, x0, y1), texel(level, x1, y1), fx),
             fy);
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
    float ratio = clamp(longer / max(shorter, 1e-6f), 1.0f, longer > 1.0f ? float(kMostTaps) : 1.0f);
    taps = int(ratio + 0.5f);
    float width = max(longer / float(taps), 1.0f);
    float lod = width > 1.0f ? clamp(log2(width), 0.0f, float(last)) : 0.0f;
    fine = int(lod);
    blend = lod - float(fine);
  }
  vec4 sum = vec4(0.0f);
  for (int i = 0; i < taps; ++i) {
    vec2 at = within(taps > 1 ? uv + axis * ((float(i) + 0.5f) / float(taps) - 0.5f) : uv);
    vec4 color = bilinear(levels.at[image.first_level + fine], at);
    if (blend > 0.0f) color = mix(color, bilinear(levels.at[image.first_level + fine + 1], at), blend);
    sum += color;
  }
  return sum / float(taps);
}

// Of the finest level, bilinear.
float sample_alpha(int index, vec2 uv) {
  CaptureTexture image = Textures(table[kTexturesSlot]).at[index];
  return bilinear(Levels(table[kLevelsSlot]).at[image.first_level], within(uv)).a;
}

// ---- triangles ----

// Four vectors: three corners, and in their last components the mesh and the corners' numbers, and what it is. Of a
// point, p0 is its place, p1 a disc's normal, p2.x its radius.
struct Triangle {
  vec3 p0, p1, p2;
  int mesh;
  ivec3 corner;
  int kind;
};

Triangle triangle_at(int k) {
  Vectors from = Vectors(table[kTrianglesSlot]);
  vec4 a = from.at[4 * k], b = from.at[4 * k + 1], c = from.at[4 * k + 2], d = from.at[4 * k + 3];
  return Triangle(a.xyz, b.xyz, c.xyz, floatBitsToInt(a.w),
                  ivec3(floatBitsToInt(b.w), floatBitsToInt(c.w), floatBitsToInt(d.x)), floatBitsToInt(d.y));
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

struct Ray {
  vec3 origin, direction;
  float nearest, farthest;
};

struct Hit {
  float t, u, v;  // u, v: weights of the second and third corner
  int triangle;   // below 0: none
};

bool cut_away(Triangle triangle, float u, float v) {
  CaptureMesh mesh = Meshes(table[kMeshesSlot]).at[triangle.mesh];
  if (mesh.masked == 0) return false;
  vec2 uv = uv_at(triangle.corner.x) * (1.0f - u - v) + uv_at(triangle.corner.y) * u + uv_at(triangle.corner.z) * v;
  return sample_alpha(mesh.texture_index, uv) < mesh.cutoff;
}

// The same of a disc, or of a sphere, on whichever side the ray meets it.
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

// Whether the ray meets the triangle before `hit`, which it then becomes. By edges' signed volumes, which two triangles
// that share an edge compute alike, so that no ray passes between them [Shoemake 1998].
bool meets(Ray ray, int k, inout Hit hit) {
  Triangle triangle = triangle_at(k);
  if (triangle.kind != kTriangle) return meets_point(ray, triangle, k, hit);
  vec3 v0 = triangle.p0 - ray.origin, v1 = triangle.p1 - ray.origin, v2 = triangle.p2 - ray.origin;
  vec3 e0 = v2 - v0, e1 = v0 - v1, e2 = v1 - v2;
  precise float u = dot(cross(e0, v2 + v0), ray.direction);
  precise float v = dot(cross(e1, v0 + v1), ray.direction);
  precise float w = dot(cross(e2, v1 + v2), ray.direction);
  float sum = u + v + w;
  float rounding = kEdgeRounding * abs(sum);
  if (min(min(u, v), w) < -rounding && max(max(u, v), w) > rounding) return false;
  vec3 across = cross(e0, e1);
  float t = dot(v0, across) / dot(across, ray.direction);
  if (!(t > ray.nearest && t < hit.t) || sum == 0.0f) return false;
  u = clamp(u / sum, 0.0f, 1.0f);
  v = clamp(v / sum, 0.0f, 1.0f);
  if (cut_away(triangle, u, v)) return false;
  hit = Hit(t, u, v, k);
  return true;
}

// The first triangle that the ray meets, or, with `any`, some one.
Hit trace(Ray ray, bool any) {
  Hit hit = Hit(ray.farthest, 0.0f, 0.0f, -1);
  Vectors nodes = Vectors(table[kNodesSlot]);
  // A direction of 0 must not give 0 times infinity.
  vec3 size = max(abs(ray.direction), vec3(1e-30f));
  vec3 inverse = vec3(ray.direction.x < 0.0f ? -1.0f : 1.0f, ray.direction.y < 0.0f ? -1.0f : 1.0f,
                      ray.direction.z < 0.0f ? -1.0f : 1.0f) /
                 size;
  const float kRounding = 1.0000005f;  // boxes are met a little early rather than missed
  int stack[kHierarchyDepth];
  int waiting = 0, at = C.root;
  while (true) {
    if (at < 0) {
      int first = ~at >> 3, count = ~at & 7;
      for (int k = first; k < first + count; ++k)
        if (meets(ray, k, hit) && any) return hit;
    } else {
      vec4 a = nodes.at[4 * at], b = nodes.at[4 * at + 1], c = nodes.at[4 * at + 2], d = nodes.at[4 * at + 3];
      vec3 a0 = (a.xyz - ray.origin) * inverse, a1 = (b.xyz - ray.origin) * inverse;
      vec3 b0 = (c.xyz - ray.origin) * inverse, b1 = (d.xyz - ray.origin) * inverse;
      vec3 a_low = min(a0, a1), a_high = max(a0, a1), b_low = min(b0, b1), b_high = max(b0, b1);
      float a_in = max(largest_of(a_low), ray.nearest), b_in = max(largest_of(b_low), ray.nearest);
      float a_out = min(min(a_high.x, a_high.y), a_high.z) * kRounding;
      float b_out = min(min(b_high.x, b_high.y), b_high.z) * kRounding;
      bool meets_a = a_in <= min(a_out, hit.t), meets_b = b_in <= min(b_out, hit.t);
      int first = floatBitsToInt(a.w), second = floatBitsToInt(c.w);
      if (meets_a && meets_b) {
        bool swapped = b_in < a_in;
        stack[waiting] = swapped ? first : second;
        ++waiting;
        at = swapped ? second : first;
        continue;
      }
      if (meets_a || meets_b) {
        at = meets_a ? first : second;
        continue;
      }
    }
    if (waiting == 0) return hit;
    --waiting;
    at = stack[waiting];
  }
  return hit;
}

// ---- surfaces ----

struct Surface {
  Triangle triangle;
  float u, v;
  vec3 position, geometric, normal;
};

vec3 unit(vec3 v) {
  float largest = largest_of(abs(v));
  return largest > 0.0f ? normalize(v / largest) : vec3(0.0f, 0.0f, 1.0f);
}

Surface surface_at(Ray ray, Hit hit) {
  Surface s;
  s.triangle = triangle_at(hit.triangle);
  s.u = hit.u;
  s.v = hit.v;
  s.position = ray.origin + ray.direction * hit.t;
  bool point = s.triangle.kind != kTriangle;
  vec3 geometric = cross(s.triangle.p1 - s.triangle.p0, s.triangle.p2 - s.triangle.p0);
  if (point) geometric = s.triangle.kind == kDisc ? s.triangle.p1 : unit(s.position - s.triangle.p0);
  vec3 normal = normal_at(s.triangle.corner.x) * (1.0f - hit.u - hit.v) + normal_at(s.triangle.corner.y) * hit.u +
                normal_at(s.triangle.corner.z) * hit.v;
  if (point) normal = geometric;
  if (dot(geometric, ray.direction) > 0.0f) geometric = -geometric;
  if (dot(normal, geometric) < 0.0f) normal = -normal;
  s.geometric = unit(geometric);
  float size = length(normal);
  normal = size > 1e-12f ? normal / size : s.geometric;
  float away = dot(normal, ray.direction);
  if (away > 0.0f) normal = normalize(normal - ray.direction * (away / dot(ray.direction, ray.direction) * 1.001f));
  s.normal = normal;
  return s;
}

vec3 start_to_light(Surface s) {
  vec3 extent = abs(s.position) + abs(s.position - three(C.eye));
  vec3 start = s.position + s.geometric * (kStartOffset * largest_of(extent));
  if (s.triangle.kind == kDisc) start += s.geometric * (kAboveDisc * s.triangle.p2.x);
  if (s.triangle.kind != kTriangle) return start;
  const float kFlat = 1.0f - 1e-6f;
  vec3 n0 = normal_at(s.triangle.corner.x), n1 = normal_at(s.triangle.corner.y), n2 = normal_at(s.triangle.corner.z);
  float f0 = dot(n0, s.geometric), f1 = dot(n1, s.geometric), f2 = dot(n2, s.geometric);
  if (abs(f0) > kFlat && abs(f1) > kFlat && abs(f2) > kFlat) return start;
  if (f0 < 0.0f) n0 = -n0;
  if (f1 < 0.0f) n1 = -n1;
  if (f2 < 0.0f) n2 = -n2;
  vec3 lift = n0 * ((1.0f - s.u - s.v) * max(-dot(s.position - s.triangle.p0, n0), 0.0f)) +
              n1 * (s.u * max(-dot(s.position - s.triangle.p1, n1), 0.0f)) +
              n2 * (s.v * max(-dot(s.position - s.triangle.p2, n2), 0.0f));
  return start + lift;
}

vec3 origin_at(vec2 p) { return three(C.origin) + three(C.origin_x) * p.x + three(C.origin_y) * p.y; }
vec3 direction_at(vec2 p) { return three(C.direction) + three(C.direction_x) * p.x + three(C.direction_y) * p.y; }

// How far texture coordinates move from the surface to where the ray of a neighbouring pixel meets its plane.
vec2 uv_change(Surface s, vec2 pixel, vec3 across, vec3 gradient_u, vec3 gradient_v) {
  vec3 origin = origin_at(pixel), direction = direction_at(pixel);
  float t = dot(across, s.position - origin) / dot(across, direction);
  vec3 moved = origin + direction * t - s.position;
  return vec2(dot(moved, gradient_u), dot(moved, gradient_v));
}

// A texture averaged over the pixel.
vec3 pixel_texel(Surface s, int index, vec2 pixel) {
  vec3 e1 = s.triangle.p1 - s.triangle.p0, e2 = s.triangle.p2 - s.triangle.p0, across = cross(e1, e2);
  vec2 t0 = uv_at(s.triangle.corner.x), t1 = uv_at(s.triangle.corner.y) - t0, t2 = uv_at(s.triangle.corner.z) - t0;
  float inverse = 1.0f / dot(across, across);
  vec3 gradient1 = cross(e2, across) * inverse, gradient2 = cross(across, e1) * inverse;
  vec3 gradient_u = gradient1 * t1.x + gradient2 * t2.x, gradient_v = gradient1 * t1.y + gradient2 * t2.y;
  return sample_filtered(index, t0 + t1 * s.u + t2 * s.v,
                         uv_change(s, pixel + vec2(1.0f, 0.0f), across, gradient_u, gradient_v),
                         uv_change(s, pixel + vec2(0.0f, 1.0f), across, gradient_u, gradient_v)).rgb;
}

vec3 color_at(int vertex) {
  Floats from = Floats(table[kColorsSlot]);
  return vec3(from.at[3 * vertex], from.at[3 * vertex + 1], from.at[3 * vertex + 2]);
}

vec3 pixel_albedo(Surface s, CaptureMesh mesh, vec2 pixel) {
  vec3 albedo = three(mesh.albedo);
  if (mesh.colored != 0) {
    ivec3 at = s.triangle.corner + mesh.color_shift;
    albedo *= color_at(at.x) * (1.0f - s.u - s.v) + color_at(at.y) * s.u + color_at(at.z) * s.v;
  }
  return mesh.texture_index < 0 ? albedo : albedo * pixel_texel(s, mesh.texture_index, pixel);
}

vec3 pixel_emission(Surface s, CaptureMesh mesh, vec2 pixel) {
  vec3 emission = three(mesh.emission);
  return mesh.emission_texture < 0 ? emission : emission * pixel_texel(s, mesh.emission_texture, pixel);
}

// ---- shadows ----

vec2 disc_point(int set, int k) {
  Floats from = Floats(table[kPointsSlot]);
  return vec2(from.at[2 * (16 * set + k)], from.at[2 * (16 * set + k) + 1]);
}

void disc_axes(vec3 direction, out vec3 right, out vec3 up) {
  vec3 axis = normalize(direction);
  right = normalize(cross(axis, abs(axis.x) < 0.7f ? vec3(1.0f, 0.0f, 0.0f) : vec3(0.0f, 1.0f, 0.0f)));
  up = cross(right, axis);
}

// How wide penumbrae are in the pixel's block: rays/shadow_lights.h.
void narrow(int block, vec2 radius_squared) {
  atomicMin(block_across[block], floatBitsToUint(radius_squared.x));
  atomicMin(block_down[block], floatBitsToUint(radius_squared.y));
}

float penumbra_pixels(Surface s, float depth, vec3 origin_step, vec3 direction, vec3 direction_step, vec3 toward,
                      float radius) {
  vec3 moved = origin_step + depth * direction_step;
  moved -= direction * (dot(s.normal, moved) / dot(s.normal, direction));
  float along = dot(moved, toward);
  float across = dot(moved, moved) - along * along / dot(toward, toward);
  return across > 0.0f ? radius * radius / across : 0.0f;
}

// What casts a shadow's ray.
struct Receiver {
  Surface s;
  vec3 start;      // of the ray
  float depth;
  vec3 direction;  // of the camera's ray
  int block;
  bool measured;   // penumbrae of this layer are asked for
};

// Whether a ray to a place on the light's disc arrives.
bool arrives(Receiver r, int light, bool soft, vec2 place) {
  bool point = C.light_point[light] != 0;
  vec3 where = light_vector(C.light_where, light), middle = point ? where - r.s.position : where, toward = middle;
  bool faces = dot(r.s.normal, toward) > 0.0f;
  if (faces && soft) {
    vec3 right = light_vector(C.light_right, light), up = light_vector(C.light_up, light);
    if (point) disc_axes(toward, right, up);
    where += C.light_size[light] * (place.x * right + place.y * up);
    toward = point ? where - r.s.position : where;
    faces = dot(r.s.normal, toward) > 0.0f;
  }
  if (!faces) {
    if (r.measured) narrow(r.block, vec2(0.0f));
    return false;
  }
  Ray ray = point ? Ray(r.start, where - r.start, 0.0f, 1.0f) : Ray(r.start, toward, 0.0f, kInfinity);
  Hit hit = trace(ray, !(soft && r.measured));
  if (hit.triangle < 0) return true;
  if (soft && r.measured) {
    float radius = C.light_size[light] * (point ? hit.t / max(1.0f - hit.t, 1e-6f) : hit.t);
    narrow(r.block, vec2(penumbra_pixels(r.s, r.depth, three(C.origin_x), r.direction, three(C.direction_x), middle, radius),
                         penumbra_pixels(r.s, r.depth, three(C.origin_y), r.direction, three(C.direction_y), middle, radius)));
  }
  return false;
}

// The share of a light that arrives. Called by all pixels of the workgroup together.
float shadow_of(Receiver r, bool there, int light, int k) {
  int rays = C.light_rays[light], block = r.block;
  float lit = 0.0f;
  bool partly = rays > 0;
  if (rays != 1) {
    if (there && arrives(r, light, rays > 0, disc_point(kCaptureDiscPoints, k))) lit = 1.0f;
    barrier();
    if (k == 0) block_pixels[block] = block_lit[block] = 0;
    barrier();
    if (there) atomicAdd(block_pixels[block], 1);
    if (lit > 0.0f) atomicAdd(block_lit[block], 1);
    barrier();
    partly = partly && block_lit[block] != 0 && block_lit[block] != block_pixels[block];
  }
  if (!partly || !there) return lit;
  lit = 0.0f;
  for (int ray = 0; ray < rays; ++ray)
    if (arrives(r, light, true, disc_point((ray + C.sample_index * rays) % kCaptureDiscPoints, k))) lit += 1.0f;
  return lit / float(rays);
}

// ---- planes ----

void put(int slot, int place, float v) {
  uvec2 address = table[slot];
  if ((address.x | address.y) != 0u) OutPlane(address).at[place] = v;
}

void put3(int slot, int place, vec3 v) {
  put(slot, place, v.x);
  put(slot + 1, place, v.y);
  put(slot + 2, place, v.z);
}

void put_surface(int first, int place, bool there, float depth, vec3 normal, vec3 albedo, vec3 emission,
                 float specular, CaptureMesh mesh) {
  put(first + kDepthSlot, place, there ? depth : kInfinity);
  mat3 to_view = transpose(mat3(C.to_view[0], C.to_view[1], C.to_view[2], C.to_view[3], C.to_view[4], C.to_view[5],
                                C.to_view[6], C.to_view[7], C.to_view[8]));
  put3(first + kNormalSlot, place, there ? to_view * normal : vec3(0.0f));
  put3(first + kAlbedoSlot, place, there ? albedo : vec3(0.0f));
  put(first + kSpecularSlot, place, there ? specular : 0.0f);
  put(first + kShininessSlot, place, there ? mesh.shininess : 0.0f);
  put3(first + kEmissionSlot, place, there ? emission : vec3(0.0f));
  put(first + kObjectSlot, place, there ? mesh.object_id : -1.0f);
  put(first + kMaterialSlot, place, there ? mesh.material_id : -1.0f);
  for (int light = 0; light < kCaptureLights; ++light) put(first + kShadowSlot + light, place, 1.0f);
}

void main() {
  ivec2 here = ivec2(gl_GlobalInvocationID.xy), local = ivec2(gl_LocalInvocationID.xy);
  bool inside = here.x < C.width && here.y < C.height;
  int place = here.y * C.stride + here.x;
  int block = local.y / 4 * 2 + local.x / 4, k = local.y % 4 * 4 + local.x % 4;
  vec2 pixel = vec2(here) + 0.5f;

  Ray ray = Ray(origin_at(pixel), direction_at(pixel), 0.0f, kInfinity);
  bool wanted = inside && C.nothing == 0;
  uvec2 before = table[kBeforeSlot];
  if (wanted && (before.x | before.y) != 0u) {
    float depth = Floats(before).at[place];
    wanted = depth < kInfinity;
    vec3 hit = ray.origin + ray.direction * depth;
    ray.nearest = depth + kLayerStep * (length(hit) + distance(hit, three(C.eye))) / length(ray.direction);
  }
  Hit hit = Hit(kInfinity, 0.0f, 0.0f, -1);
  if (wanted) hit = trace(ray, false);
  bool there = hit.triangle >= 0;
  Surface s;
  CaptureMesh mesh;
  vec3 albedo = vec3(0.0f), emission = vec3(0.0f);
  if (there) {
    s = surface_at(ray, hit);
    mesh = Meshes(table[kMeshesSlot]).at[s.triangle.mesh];
    albedo = pixel_albedo(s, mesh, pixel);
    emission = pixel_emission(s, mesh, pixel);
  }
  for (int side = 0; side <= C.back; ++side) {
    int first = side * kBackSlots;
    if (side == 1 && there) {
      s.geometric = -s.geometric;
      s.normal = -s.normal;
    }
    if (inside) put_surface(first, place, there, hit.t, s.normal, albedo, emission, side == 0 ? mesh.specular : 0.0f, mesh);
    vec3 start = there ? start_to_light(s) : vec3(0.0f);
    for (int light = 0; light < C.light_count; ++light) {
      int radii = kPenumbraSlot + 2 * C.light_index[light];
      bool measured = (table[radii].x | table[radii].y) != 0u && side == 0;
      if (measured) {
        barrier();
        if (k == 0) block_across[block] = block_down[block] = floatBitsToUint(kInfinity);
        barrier();
      }
      Receiver receiver = Receiver(s, start, hit.t, ray.direction, block, measured);
      float lit = shadow_of(receiver, there, light, k);
      if (there) put(first + kShadowSlot + C.light_index[light], place, lit);
      if (measured) {
        barrier();
        if (k == 0 && inside) {
          int at = here.y / kSoftenBlock * C.stride + here.x / kSoftenBlock;
          put(radii, at, sqrt(uintBitsToFloat(block_across[block])));
          put(radii + 1, at, sqrt(uintBitsToFloat(block_down[block])));
        }
      }
    }
  }
}
