// Traces one ray of each pixel in the captured scene, and adds it to the outputs of a dispatch that traces rays, as
// devices/cpu/trace_rays.cpp does on the CPU: see Dispatch::rays.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "devices/vulkan/hit_light.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer InOutPlane { float at[]; };

const float kRayLimit = 1e18f;  // as in rays/traced_scene.h

vec3 load3(int slot, int index) {
  return vec3(Floats(table[slot]).at[index], Floats(table[slot + 1]).at[index], Floats(table[slot + 2]).at[index]);
}

// Returns the weight of an occluder at distance `fraction` times the length of the ray, as in core/effect.h.
float falloff_weight(float fraction) {
  if (C.falloff == kNoFalloff) return 1.0f;
  if (C.falloff == kLinearFalloff) return 1.0f - fraction;
  return 1.0f - fraction * fraction * (3.0f - 2.0f * fraction);
}

bool is_stored(int slot) { return (table[slot].x | table[slot].y) != 0u; }

vec3 sum_at(int slot, int index) {
  return vec3(InOutPlane(table[slot]).at[index], InOutPlane(table[slot + 1]).at[index],
              InOutPlane(table[slot + 2]).at[index]);
}

void store3(int slot, int index, vec3 v) {
  for (int axis = 0; axis < 3; ++axis) InOutPlane(table[slot + axis]).at[index] = v[axis];
}

// Returns l.d times `first`, plus d'Qd times `second`, as sky_radiance() in core/light.h does.
vec3 sky_radiance(vec3 d, float first, float second) {
  vec3 radiance;
  for (int c = 0; c < 3; ++c) {
    int k = 9 * c;
    radiance[c] = (C.sky[k] * d.x + C.sky[k + 1] * d.y + C.sky[k + 2] * d.z) * first +
                  (C.sky[k + 3] * d.x * d.x + C.sky[k + 4] * d.y * d.y + C.sky[k + 5] * d.z * d.z +
                   2.0f * (C.sky[k + 6] * d.x * d.y + C.sky[k + 7] * d.y * d.z + C.sky[k + 8] * d.z * d.x)) *
                      second;
  }
  return radiance;
}

// Returns what a blocked ray changes in the ambient light of its pixel.
vec3 hidden_sky(vec3 direction, vec3 offset) {
  float size = max_component(abs(offset));
  if (C.directional == 0.0f || !(size > 0.0f)) return vec3(0.0f);
  // Divided by its size first, since the square of a short vector underflows.
  vec3 normal = normalize(offset / size);
  return (sky_radiance(normal, 2.0f / 3.0f, 0.25f) - sky_radiance(direction, 1.0f, 1.0f)) * C.directional;
}

void main() {
  ivec2 here = ivec2(gl_GlobalInvocationID.xy);
  if (here.x >= C.width || here.y >= C.height) return;
  int index = here.y * C.stride + here.x;
  bool first = C.ray == 0, last = C.ray == C.last_ray;
  vec3 direction = load3(kRaySlot, index);
  bool has_ray = direction != vec3(0.0f);
  if (!has_ray && !first && !last) return;

  InOutPlane open_plane = InOutPlane(table[kOpenSlot]), confidence_plane = InOutPlane(table[kConfidenceSlot]);
  bool has_bent = is_stored(kBentSlot), has_light = is_stored(kIndirectSlot);
  // Until the last ray, the planes contain sums: of visibility and of rays.
  float open = first ? 0.0f : open_plane.at[index], count = first ? 0.0f : confidence_plane.at[index];
  vec3 bent = has_bent && !first ? sum_at(kBentSlot, index) : vec3(0.0f);
  vec3 light = has_light && !first ? sum_at(kIndirectSlot, index) : vec3(0.0f);
  vec3 offset = load3(kRayOffsetSlot, index);
  if (has_ray && !(dot(direction, offset) > 0.0f)) {  // below the triangle: blocked, and without reflected light
    count += 1.0f;
    light += hidden_sky(direction, offset);
  } else if (has_ray) {
    mat3 to_world = transpose(view_rotation());
    vec2 pixel = vec2(here) + 0.5f;
    vec3 start = origin_at(pixel) + direction_at(pixel) * Floats(table[kDepthSlot]).at[index] +
                 to_world * (offset * C.unit_scale);
    Ray ray = Ray(start, to_world * direction, 0.0f, C.ray_length);
    if (max_component(abs(start)) < kRayLimit && max_component(abs(ray.direction)) < kRayLimit) {
      bool reflects = has_light && C.light > 0.0f;
      Hit hit = trace(ray, C.falloff == kNoFalloff && !reflects, C.min_opacity);
      float blocked = hit.triangle < 0 ? 0.0f : falloff_weight(min(hit.t / C.ray_length, 1.0f));
      float visible = 1.0f - blocked;
      if (reflects && blocked > 0.0f) {
        uint seed = hash(hash(hash(uint(here.x), uint(C.seed)), uint(here.y)), uint(C.ray));
        light += light_of_hit(ray, hit, seed) * (blocked * C.light);
      }
      if (blocked > 0.0f) light += hidden_sky(direction, offset) * blocked;
      open += visible;
      count += 1.0f;
      bent += direction * visible;
    }
  }
  if (last) {
    open = count > 0.0f ? open / count : 1.0f;
    float size = length(bent);
    bent = size > 0.0f ? bent / size : vec3(0.0f);
    light /= max(count, 1.0f);
  }
  open_plane.at[index] = open;
  confidence_plane.at[index] = last ? count / (count + 1.0f) : count;
  if (has_bent) store3(kBentSlot, index, bent);
  if (has_light) store3(kIndirectSlot, index, light);
}
