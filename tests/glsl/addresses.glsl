// Planes read by their addresses, as in kernel/glsl.h.
layout(buffer_reference, scalar, buffer_reference_align = 4) restrict readonly buffer InPlane { float at[]; };

float depth_at(ivec2 p) { return InPlane(planes[0]).at[p.y * F.stride + p.x]; }
vec3 normal_at(ivec2 p) {
  int k = p.y * F.stride + p.x;
  return vec3(InPlane(planes[1]).at[k], InPlane(planes[2]).at[k], InPlane(planes[3]).at[k]);
}
