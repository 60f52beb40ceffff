// The light that the surfaces which rays hit send back along the rays, as in rays/hit_light.cpp (trace_rays.comp).
#ifndef UMBRAGE_DEVICES_VULKAN_HIT_LIGHT_GLSL
#define UMBRAGE_DEVICES_VULKAN_HIT_LIGHT_GLSL
#include "devices/vulkan/surface.glsl"
#include "devices/vulkan/trace.glsl"

// Return a hash and a random number, as in core/hash.h.
uint hash(uint a, uint b) {
  uint v = a ^ (b * 0x9e3779b9u + 0x7f4a7c15u);
  v = (v ^ (v >> 16)) * 0x7feb352du;
  v = (v ^ (v >> 15)) * 0x846ca68bu;
  return v ^ (v >> 16);
}
float unit_real(uint bits) { return (float(bits >> 9) + 0.5f) * (1.0f / 8388608.0f); }

// Return a basis with the third axis n, and a direction about +z, as in rays/directions.h.
mat3 basis_around(vec3 n) {
  float signed_one = floatBitsToInt(n.z) < 0 ? -1.0f : 1.0f;  // -1 for -0 too, as std::copysign
  float a = -1.0f / (signed_one + n.z), b = n.x * n.y * a;
  return mat3(1.0f + signed_one * n.x * n.x * a, signed_one * b, -signed_one * n.x, b, signed_one + n.y * n.y * a, -n.y,
              n.x, n.y, n.z);
}
vec3 cosine_direction(vec2 at) {
  const float kQuarter = 0.785398163f;
  float a = 2.0f * at.x - 1.0f, b = 2.0f * at.y - 1.0f, radius = 0.0f, angle = 0.0f;
  if (abs(a) > abs(b)) {
    radius = a;
    angle = kQuarter * (b / a);
  } else if (b != 0.0f) {
    radius = b;
    angle = 2.0f * kQuarter - kQuarter * (a / b);
  }
  return vec3(radius * cos(angle), radius * sin(angle), sqrt((1.0f - radius) * (1.0f + radius)));
}

// Light that arrives at a surface unless something blocks it: direction to the light, its distance, and what the surface
// reflects of it.
struct ArrivingLight {
  vec3 direction;
  float distance;
  vec3 reflected;
};

ArrivingLight arriving_light(CaptureHitLight light, Surface s, vec3 albedo) {
  vec3 where = to_vec3(light.where), color = to_vec3(light.color), eye = to_vec3(C.eye);
  ArrivingLight arriving = ArrivingLight(where, kInfinity, vec3(0.0f));
  if (light.point != 0) {
    vec3 to_center = where - s.position;
    float squared = max(dot(to_center, to_center), 1e-20f);
    arriving.distance = sqrt(squared);
    arriving.direction = to_center / arriving.distance;
    if (light.reach_squared > 0.0f) color *= light.reach_squared / max(squared, light.min_squared);
  } else if (light.from_camera != 0) {
    arriving.distance = dot(eye - s.position, where);
  }
  arriving.reflected = albedo * color * max(dot(s.normal, arriving.direction), 0.0f);
  return arriving;
}

vec3 ambient_at(vec3 normal) {
  vec3 ambient = to_vec3(C.ambient);
  if (C.even_ambient != 0) return ambient;
  vec4 n = vec4(view_rotation() * normal, 1.0f);
  for (int color = 0; color < 3; ++color)
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 4; ++row)
        ambient[color] += C.ambient_shape[16 * color + 4 * column + row] * n[column] * n[row];
  return max(ambient, vec3(0.0f));
}

// Returns the finest texels of a texture at a surface; white if there is no texture.
vec3 unfiltered_texel(Surface s, int index) {
  if (index < 0) return vec3(1.0f);
  vec2 uv = uv_at(s.triangle.corner.x) * (1.0f - s.u - s.v) + uv_at(s.triangle.corner.y) * s.u +
            uv_at(s.triangle.corner.z) * s.v;
  return sample_filtered(index, uv, vec2(0.0f), vec2(0.0f)).rgb;
}

float brightness(vec3 color) { return color.r + color.g + color.b; }

// Returns the radiance along a ray from the surface that it hits. Of the lights that cast shadows and the ambient light,
// one is chosen at random by its brightness without shadow, and one ray tests whether it arrives.
vec3 light_of_hit(Ray ray, Hit hit, uint seed) {
  Surface s = surface_at(ray, hit);
  CaptureMesh mesh = Meshes(table[kMeshesSlot]).at[s.triangle.mesh];
  vec3 albedo = to_vec3(mesh.albedo) * mesh_color(s, mesh) * unfiltered_texel(s, mesh.texture_index);
  vec3 light = to_vec3(mesh.emission) * unfiltered_texel(s, mesh.emission_texture);
  light *= C.max_emission / max(max(light.x, light.y), max(light.z, C.max_emission));
  vec3 of_ambient = albedo * ambient_at(s.normal);
  float sum = 0.0f;
  for (int k = 0; k < C.hit_light_count; ++k) {
    vec3 reflected = arriving_light(C.hit_lights[k], s, albedo).reflected;
    if (C.hit_lights[k].casts_shadow == 0)
      light += reflected;
    else
      sum += brightness(reflected);
  }
  sum += brightness(of_ambient);
  // Ambient light is the last candidate: it is chosen if the others leave a rest.
  float rest = unit_real(hash(seed, 1u)) * sum;
  ArrivingLight chosen = ArrivingLight(vec3(0.0f), C.ray_length, of_ambient);
  bool is_ambient = true;
  for (int k = 0; k < C.hit_light_count && rest >= 0.0f; ++k) {
    if (C.hit_lights[k].casts_shadow == 0) continue;
    ArrivingLight candidate = arriving_light(C.hit_lights[k], s, albedo);
    float of_light = brightness(candidate.reflected);
    if (!(of_light > 0.0f)) continue;
    chosen = candidate;
    is_ambient = false;
    rest -= of_light;
  }
  if (rest >= 0.0f && brightness(of_ambient) > 0.0f) {
    is_ambient = true;
    chosen = ArrivingLight(vec3(0.0f), C.ray_length, of_ambient);
  }
  float of_chosen = brightness(chosen.reflected);
  if (!(of_chosen > 0.0f)) return light;
  vec3 start;
  if (is_ambient) {
    chosen.direction =
        basis_around(s.normal) * cosine_direction(vec2(unit_real(hash(seed, 2u)), unit_real(hash(seed, 3u))));
    if (!(dot(chosen.direction, s.geometric) > 0.0f)) return light;
    start = s.position + s.geometric * ray_origin_height(s, ray.origin);
  } else {
    start = ray_origin_to_light(s, ray.origin);
  }
  Hit blocker = trace(Ray(start, chosen.direction, 0.0f, chosen.distance), true, C.min_opacity);
  return blocker.triangle < 0 ? light + chosen.reflected * (sum / of_chosen) : light;
}

#endif
