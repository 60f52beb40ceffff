// What the hand-written shaders share: they store the visibility of each pixel, visibility_at where there is a surface, 1
// elsewhere.
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 5, scalar) writeonly buffer ao_plane { float ao[]; };

#if defined(PLANES_IN_ADDRESSES)  // as in kernel/glsl.h
layout(buffer_reference, scalar, buffer_reference_align = 4) restrict readonly buffer InPlane { float at[]; };

float depth_at(ivec2 p) { return InPlane(planes[0]).at[p.y * F.stride + p.x]; }
vec3 normal_at(ivec2 p) {
  int k = p.y * F.stride + p.x;
  return vec3(InPlane(planes[1]).at[k], InPlane(planes[2]).at[k], InPlane(planes[3]).at[k]);
}
#elif defined(PLANES_IN_BUFFERS)
layout(set = 0, binding = 1, scalar) readonly buffer depth_plane { float depth[]; };
layout(set = 0, binding = 2, scalar) readonly buffer normal_x_plane { float normal_x[]; };
layout(set = 0, binding = 3, scalar) readonly buffer normal_y_plane { float normal_y[]; };
layout(set = 0, binding = 4, scalar) readonly buffer normal_z_plane { float normal_z[]; };

float depth_at(ivec2 p) { return depth[p.y * F.stride + p.x]; }
vec3 normal_at(ivec2 p) {
  int k = p.y * F.stride + p.x;
  return vec3(normal_x[k], normal_y[k], normal_z[k]);
}
#else  // as in an engine's G-buffer
layout(set = 0, binding = 1) uniform sampler2D depth_image;
layout(set = 0, binding = 2) uniform sampler2D normal_image;

float depth_at(ivec2 p) { return texelFetch(depth_image, p, 0).x; }
vec3 normal_at(ivec2 p) { return texelFetch(normal_image, p, 0).xyz; }
#endif

// Returns the view-space position of the surface at a pixel's centre, for a perspective camera.
vec3 position_at(ivec2 p, float z) {
  vec2 ray = (vec2(p) + 0.5) * vec2(F.ray_scale_x, F.ray_scale_y) + vec2(F.ray_offset_x, F.ray_offset_y);
  return vec3(ray, -1.0) * z;
}

float visibility_at(ivec2 here, float z);

void main() {
  ivec2 here = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(here, ivec2(F.width, F.height)))) return;
  float z = depth_at(here);
  ao[here.y * F.stride + here.x] = isinf(z) ? 1.0 : visibility_at(here, z);
}
