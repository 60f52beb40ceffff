// The surface at the hit of a ray, as in rays/traced_scene.cpp (capture.comp, trace_rays.comp).
#ifndef UMBRAGE_DEVICES_VULKAN_SURFACE_GLSL
#define UMBRAGE_DEVICES_VULKAN_SURFACE_GLSL
#include "devices/vulkan/capture_scene.glsl"

const float kStartOffset = 4e-6f;   // as in rays/traced_scene.cpp
const float kDiscRayOffset = 0.3f;  // as in rays/traced_scene.h

struct Surface {
  Triangle triangle;
  float u, v;
  vec3 position, geometric, normal;
};

vec3 unit(vec3 v) {
  float max_abs = max_component(abs(v));
  return max_abs > 0.0f ? normalize(v / max_abs) : vec3(0.0f, 0.0f, 1.0f);
}

// Returns the normal of a disc at a point on it, as bent_normal in scene/point_normals.cpp.
vec3 bent_normal(Triangle disc, vec3 position) {
  vec3 right = normalize(cross(disc.p1, abs(disc.p1.x) < 0.7f ? vec3(1.0f, 0.0f, 0.0f) : vec3(0.0f, 1.0f, 0.0f)));
  vec3 up = cross(right, disc.p1), offset = position - disc.p0;
  float x = dot(offset, right), y = dot(offset, up);
  return normalize(disc.p1 + right * (disc.p2.y * x + disc.p2.z * y) + up * (disc.p2.z * x + disc.bend * y));
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
  if (point) normal = s.triangle.kind == kDisc ? bent_normal(s.triangle, s.position) : geometric;
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

// Returns the height above the surface at which rays start, as in rays/traced_scene.cpp. `seen_from`: origin of the ray
// that hit the surface.
float ray_origin_height(Surface s, vec3 seen_from) {
  vec3 extent = abs(s.position) + abs(s.position - seen_from);
  float height = kStartOffset * max_component(extent);
  return s.triangle.kind == kDisc ? height + kDiscRayOffset * s.triangle.p2.x : height;
}

// Returns the origin for a ray to a light, as in rays/traced_scene.cpp.
vec3 ray_origin_to_light(Surface s, vec3 seen_from) {
  vec3 start = s.position + s.geometric * ray_origin_height(s, seen_from);
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

vec3 color_at(int vertex) {
  Floats from = Floats(table[kColorsSlot]);
  return vec3(from.at[3 * vertex], from.at[3 * vertex + 1], from.at[3 * vertex + 2]);
}

// Returns the mesh's colour at a surface; white if the mesh has none.
vec3 mesh_color(Surface s, CaptureMesh mesh) {
  if (mesh.colored == 0) return vec3(1.0f);
  ivec3 at = s.triangle.corner + mesh.color_shift;
  return color_at(at.x) * (1.0f - s.u - s.v) + color_at(at.y) * s.u + color_at(at.z) * s.v;
}

#endif
