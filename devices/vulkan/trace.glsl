// Traces rays through the hierarchy of a scene, without hardware ray tracing (capture.comp, trace_rays.comp).
#ifndef UMBRAGE_DEVICES_VULKAN_TRACE_GLSL
#define UMBRAGE_DEVICES_VULKAN_TRACE_GLSL
#include "devices/vulkan/capture_scene.glsl"

// Returns whether the ray meets the triangle before `hit`, and if so replaces `hit`.
bool meets(Ray ray, int k, float min_opacity, inout Hit hit) {
  Triangle triangle = triangle_at(k);
  if (triangle.kind != kTriangle)
    return !is_cut_out(triangle, 0.0f, 0.0f, min_opacity) && meets_point(ray, triangle, k, hit);
  Crossing at = crossing_of(ray, triangle);
  if (!at.inside || !(at.t > ray.nearest && at.t < hit.t)) return false;
  float u = clamp(at.u / at.sum, 0.0f, 1.0f), v = clamp(at.v / at.sum, 0.0f, 1.0f);
  if (is_cut_out(triangle, u, v, min_opacity)) return false;
  hit = Hit(at.t, u, v, k);
  return true;
}

// Returns the nearest hit of the ray, or with `any` an arbitrary one. The ray passes through blended surfaces with less
// than `min_opacity`.
Hit trace(Ray ray, bool any, float min_opacity) {
  Hit hit = Hit(ray.farthest, 0.0f, 0.0f, -1);
  Vectors nodes = Vectors(table[kNodesSlot]);
  // Avoids 0 times infinity for a direction of 0.
  vec3 size = max(abs(ray.direction), vec3(1e-30f));
  vec3 inverse = vec3(ray.direction.x < 0.0f ? -1.0f : 1.0f, ray.direction.y < 0.0f ? -1.0f : 1.0f,
                      ray.direction.z < 0.0f ? -1.0f : 1.0f) /
                 size;
  const float kRounding = 1.0000005f;  // enlarges boxes slightly, so that none is missed
  int stack[kHierarchyDepth];
  int stack_size = 0, at = C.root;
  while (true) {
    if (at < 0) {
      int first = ~at >> 3, count = ~at & 7;
      for (int k = first; k < first + count; ++k)
        if (meets(ray, k, min_opacity, hit) && any) return hit;
    } else {
      vec4 a = nodes.at[4 * at], b = nodes.at[4 * at + 1], c = nodes.at[4 * at + 2], d = nodes.at[4 * at + 3];
      vec3 a0 = (a.xyz - ray.origin) * inverse, a1 = (b.xyz - ray.origin) * inverse;
      vec3 b0 = (c.xyz - ray.origin) * inverse, b1 = (d.xyz - ray.origin) * inverse;
      vec3 a_low = min(a0, a1), a_high = max(a0, a1), b_low = min(b0, b1), b_high = max(b0, b1);
      float a_in = max(max_component(a_low), ray.nearest), b_in = max(max_component(b_low), ray.nearest);
      float a_out = min(min(a_high.x, a_high.y), a_high.z) * kRounding;
      float b_out = min(min(b_high.x, b_high.y), b_high.z) * kRounding;
      bool meets_a = a_in <= min(a_out, hit.t), meets_b = b_in <= min(b_out, hit.t);
      int first = floatBitsToInt(a.w), second = floatBitsToInt(c.w);
      if (meets_a && meets_b) {
        bool swapped = b_in < a_in;
        stack[stack_size] = swapped ? first : second;
        ++stack_size;
        at = swapped ? second : first;
        continue;
      }
      if (meets_a || meets_b) {
        at = meets_a ? first : second;
        continue;
      }
    }
    if (stack_size == 0) return hit;
    --stack_size;
    at = stack[stack_size];
  }
  return hit;
}

#endif
