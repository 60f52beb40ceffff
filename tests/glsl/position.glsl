// Returns the view-space position of the surface at a pixel's centre, for a perspective camera.
vec3 position_at(ivec2 p, float z) {
  vec2 ray = (vec2(p) + 0.5) * vec2(F.ray_scale_x, F.ray_scale_y) + vec2(F.ray_offset_x, F.ray_offset_y);
  return vec3(ray, -1.0) * z;
}
