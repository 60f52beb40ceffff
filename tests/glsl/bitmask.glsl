// `bitmask`, written by hand for its default settings: one layer, perspective, occluders of assumed thickness, bits of
// equal cosine weight, noise of a tile of 4 x 4 pixels.

// Returns asin(c) + c sqrt(1 - c^2) for a cosine c, as an odd polynomial.
float arc(float c) {
  float c2 = c * c;
  return c * (2.0109842 + c2 * (-0.43954378 + c2 * (0.21090476 - 0.21154887 * c2)));
}

uint ones_from(float bit) {
  int b = int(bit);
  return b < 32 ? 0xffffffffu << b : 0u;
}

vec3 noise_at(ivec2 p) {
  uint x = uint(p.x) & 3u, y = uint(p.y) & 3u;
  uint turn = (((x + y) & 3u) << 2) + x;
  uint steps = (((y - x) & 3u) << 2) + (((x >> 1) + (y << 1)) & 3u);
  return (vec3(turn, steps, (turn * 7u) & 15u) + 0.5) / 16.0;
}

// One side of a slice: `sign` is 1 for its higher bits.
struct Side {
  float sign, k0, k1, k2, low;
};

float bit_of(float c, Side side) { return side.k0 + side.k1 * c * c + side.k2 * arc(c); }

float visibility_at(ivec2 here, float z) {
  ivec2 size = ivec2(F.width, F.height);
  vec3 position = position_at(here, z);
  vec3 eye = normalize(-position);
  vec3 normal = normalize(normal_at(here));
  float facing = dot(normal, eye);
  if (facing < 0.0) normal = normalize(normal + eye * (0.1 - facing));
  facing = max(dot(normal, eye), 0.1);

  float reach = min(C.radius_px / z, 1e5);
  vec3 noise = noise_at(here);
  float open = 0.0, all = 0.0;
  for (int s = 0; s < C.slices; ++s) {
    float angle = ((noise.x + float(s)) / float(C.slices) - 0.5) * 3.14159265;
    vec2 direction = vec2(cos(angle), sin(angle));
    float lean = dot(direction, eye.xy);
    float t = sqrt(max(1.0 - lean * lean, 1e-6));
    float along = (dot(normal.xy, direction) - lean * facing) / t;
    float projected = sqrt(facing * facing + along * along);
    float cn = facing / projected, sn = along / projected;
    float whole = cn * cn * cn + sn * arc(sn);
    float weight = projected * whole;
    float m = 16.0 / whole;
    float jitter = fract(noise.y + float(s) * 0.61803399);
    float middle = 16.0 + 0.01 + 0.98 * fract(noise.z + float(s) * 0.61803399);
    Side sides[2] =
        Side[2](Side(1.0, middle + m * cn, -m * cn, -m * sn, -sn), Side(-1.0, middle - m * cn, m * cn, -m * sn, sn));
    uint bits = 0u;
    vec2 inside = vec2(0.0);
    for (int k = 0; k < C.steps; ++k) {
      float fraction = (jitter + float(k)) / float(C.steps);
      float off = fraction * sqrt(fraction) * reach + 1.3;
      for (int side = 0; side < 2; ++side) {
        Side half_slice = sides[side];
        ivec2 there = ivec2(floor(vec2(here) + 0.5 + half_slice.sign * off * vec2(direction.x, direction.y * C.rows_per_column)));
        if (any(lessThan(there, ivec2(0))) || any(greaterThanEqual(there, size))) continue;
        inside[side] += 1.0;
        float tap = depth_at(there);
        if (isinf(tap)) continue;
        vec3 to_tap = position_at(there, tap) - position;
        float height = dot(to_tap, normal) - z * 2e-6;
        vec2 pixels = vec2(there - here);
        float across = dot(vec2(direction.x, direction.y * C.columns_per_row), pixels) * tap * t * F.ray_scale_x;
        float to_eye = (height - across * along) / facing;
        float across2 = max(across * across, 1e-30);
        float distance2 = to_eye * to_eye + across2;
        if (distance2 > C.radius2) continue;
        float distance = sqrt(distance2);
        float front = max(to_eye / distance, half_slice.low);
        float behind = to_eye - max(distance * C.slope, C.thickness);
        float back = max(behind / sqrt(behind * behind + across2), half_slice.low);
        bits |= ones_from(bit_of(front, half_slice)) ^ ones_from(bit_of(back, half_slice));
      }
    }
    // A side is weighted by the fraction of its taps inside the picture.
    float low = floor(16.0 - sn * 1.57079633 * m + 0.5);
    float covered_above = float(bitCount(bits & ones_from(low)));
    float covered_below = float(bitCount(bits)) - covered_above;
    vec2 inside_fraction = inside / float(C.steps);
    float whole_above = (32.0 - low) * inside_fraction.x * weight / 32.0, whole_below = low * inside_fraction.y * weight / 32.0;
    open += whole_above * (1.0 - covered_above / max(32.0 - low, 1.0)) +
            whole_below * (1.0 - covered_below / max(low, 1.0));
    all += whole_above + whole_below;
  }
  return all > 1e-6 ? min(open / all, 1.0) : 1.0;
}
