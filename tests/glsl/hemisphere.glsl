// `hemisphere`, written by hand for its default settings: one layer, perspective, no light.
float unit_float(uint v) { return float(v >> 8) / 16777216.0; }

uint scrambled(uint v) {
  v = (v ^ (v >> 16)) * 0x7feb352du;
  v = (v ^ (v >> 15)) * 0x846ca68bu;
  return v ^ (v >> 16);
}

float visibility_at(ivec2 here, float z) {
  ivec2 size = ivec2(F.width, F.height);
  vec3 position = position_at(here, z);
  vec3 normal = normalize(normal_at(here));

  // Noise of a tile of 4 x 4 pixels: an angle, and a shift of the lengths.
  uint seed = scrambled(0x9e3779b9u + uint(C.seed));
  uint index = uint(here.y % 4 * 4 + here.x % 4);
  float angle = (unit_float(index * 0xc13fa9a9u + seed) * 4.0 - 0.5) * 1.57079633;
  float shift = unit_float(index * 0x91e10da6u + seed * 3u);
  float shortening = exp(shift * C.log_inner);

  vec3 aside = normalize(cross(abs(normal.y) > 0.99 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0), normal));
  vec3 tangent = aside * cos(angle) + cross(normal, aside) * sin(angle);
  mat3 basis = mat3(tangent, cross(normal, tangent), normal) * C.radius;

  float rounding = z * 2e-6;
  float occlusion = 0.0, count = 0.0;
  for (int k = 0; k < C.samples; ++k) {
    float along = C.points[5 * k + 3], sample_weight = C.points[5 * k + 4];
    if (k % 2 == 0) {
      along *= shortening;
      if (along < C.inner) along *= C.one_over_inner;
    } else {
      along = fract(along + shift);
    }
    vec3 point = position + basis * vec3(C.points[5 * k], C.points[5 * k + 1], C.points[5 * k + 2]) * along;
    float point_z = max(-point.z, z * 1e-3);
    vec2 picture_point = point.xy / point_z * vec2(C.scale_x[0], C.scale_y[0]) + vec2(C.offset_x[0], C.offset_y[0]);
    ivec2 there = ivec2(floor(picture_point));
    if (any(lessThan(there, ivec2(0))) || any(greaterThanEqual(there, size))) continue;
    count += sample_weight;
    float tap = depth_at(there);
    if (!(tap > 0.0) || point_z - tap <= rounding + C.min_in_front) continue;
    vec3 to_tap = position_at(there, tap) - position;
    if (dot(to_tap, normal) <= rounding + C.min_height) continue;
    float fade = C.limit / max(abs(z - tap), C.limit);
    occlusion += fade * fade * (3.0 - 2.0 * fade) * sample_weight;
  }
  return max(0.0, 1.0 - occlusion * C.weight / max(count, 1e-6));
}
