// Finds the nearest triangle or point behind the previous layer in each pixel. Writes the depth of the hit of the
// pixel's ray, not the interpolated depth, which has no precision left for a triangle that extends to the camera.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "devices/vulkan/capture_scene.glsl"

layout(constant_id = 0) const bool kMasks = true;   // the scene has alpha masks
layout(constant_id = 1) const bool kPoints = true;  // the scene has points
layout(location = 0) flat in int triangle_index;
layout(location = 0) out uint triangle_number;

void main() {
  Ray ray;
  if (!pixel_ray(ivec2(gl_FragCoord.xy), ray)) discard;
  Triangle triangle = triangle_at(triangle_index);
  Hit hit =
      kPoints ? hit_of_covered(ray, triangle, triangle_index) : hit_of_covered_triangle(ray, triangle, triangle_index);
  if (!(hit.t > ray.nearest) || hit.triangle < 0) discard;
  if (kMasks && is_cut_out(triangle, hit.u, hit.v, C.min_opacity)) discard;
  triangle_number = uint(triangle_index) + 1u;
  gl_FragDepth = min(C.nearest / hit.t, 1.0f);
}
