// Planes as bound storage buffers.
layout(set = 0, binding = 1, scalar) readonly buffer depth_plane { float depth[]; };
layout(set = 0, binding = 2, scalar) readonly buffer normal_x_plane { float normal_x[]; };
layout(set = 0, binding = 3, scalar) readonly buffer normal_y_plane { float normal_y[]; };
layout(set = 0, binding = 4, scalar) readonly buffer normal_z_plane { float normal_z[]; };

float depth_at(ivec2 p) { return depth[p.y * F.stride + p.x]; }
vec3 normal_at(ivec2 p) {
  int k = p.y * F.stride + p.x;
  return vec3(normal_x[k], normal_y[k], normal_z[k]);
}
