// The near part of `shanmugam`: pixels in a disc of near_radius, each of which stands for an equal part of the disc's
// pixels. Functions in the kernel dialect; the kernel includes this file.

// Cosine and sine of the golden angle, by which each sample is rotated against the one before it.
CONST float kGoldenCos = -0.737368878f;
CONST float kGoldenSin = 0.675490294f;
// Min cosine between a surface and the view ray, so that the surface behind a pixel stays finite.
CONST float kMinFacing = 0.05f;
// Taps beyond this squared distance would make sums infinite.
CONST float kMaxDistance2 = 1e30f;

// Returns a pixel's rotation, as a fraction of a turn, and the offset of its samples, as a fraction of a step. Tiles of
// 4 x 4 pixels have sixteen of both, so that a filter of this width removes the noise.
FN Vec2 noise_at(Int px, Int py) {
  Uint x = to_uint(px) & Uint(3u);
  Uint y = to_uint(py) & Uint(3u);
  Uint turn = (((x + y) & Uint(3u)) << 2) + x;
  Uint step = (((y - x) & Uint(3u)) << 2) + (((x >> 1) + (y << 1)) & Uint(3u));
  return Vec2(fract(mad(to_real(to_signed(turn)), Real(0.0625f), Real(C.turn))),
              fract(mad(to_real(to_signed(step)), Real(0.0625f), Real(C.step))));
}

// Returns the view-space area of the surface behind the pixels that a sample stands for, exact on a plane. `area` is
// theirs at the depth of the receiver.
FN Real area_behind(Real area, Vec3 tap, Vec3 tap_normal, Real depth) {
  if (F.orthographic != 0) return area / max(tap_normal.z, Real(kMinFacing));
  Real ratio = tap.z / depth;
  Real facing = dot(tap, tap_normal) / tap.z;
  return area * ratio * ratio / max(facing, Real(kMinFacing));
}

// Returns the fraction of the hemisphere, weighted by cosine, that the samples in the disc hide; 0 to 1.
FN Real near_occlusion(Int px, Int py, Real depth, Vec3 position, Vec3 normal) {
  Vec2 noise = noise_at(px, py);
  Vec2 direction = direction_of_turn(noise.x);
  Real spread = F.orthographic != 0 ? Real(1.0f) : depth;
  Real radius_px = clamp(Real(C.radius_px) / spread, Real(0.0f), Real(1e5f));
  Real center_x = to_real(px) + 0.5f;
  Real center_y = to_real(py) + 0.5f;
  Real area = Real(C.near_area * C.one_over_samples);
  Real sum = Real(0.0f);
  Real inside = Real(0.0f);
  for (int i = 0; i < C.samples; ++i) {
    Real offset_px = sqrt((float(i) + noise.y) * C.one_over_samples) * radius_px;
    Real x = mad(direction.x, offset_px, center_x);
    Real y = mad(direction.y * C.rows_per_column, offset_px, center_y);
    direction = Vec2(mad(direction.x, Real(kGoldenCos), direction.y * -kGoldenSin),
                     mad(direction.x, Real(kGoldenSin), direction.y * kGoldenCos));
    Bool in_picture = x >= Real(0.0f) && y >= Real(0.0f) && x < Real(float(F.width)) && y < Real(float(F.height));
    Int column = to_int(floor(clamp(x, Real(0.0f), Real(float(F.width) - 0.5f))));
    Int row = to_int(floor(clamp(y, Real(0.0f), Real(float(F.height) - 0.5f))));
    Real tap_depth = load_depth(column, row);
    Vec3 tap = view_position(column, row, tap_depth);
    Vec3 to_tap = tap - position;
    Real distance2 = dot(to_tap, to_tap);
    Real one_over = rsqrt(max(distance2, Real(1e-30f)));
    Real cosine = max(mad(dot(to_tap, normal), one_over, Real(-C.bias)), Real(0.0f));
    Real term = Real(0.0f);
    if (C.sphere != 0) {
      Real ratio = F.orthographic != 0 ? Real(1.0f) : tap_depth / depth;
      Real q2 = min(area * 0.318309886f * (ratio * ratio) * (one_over * one_over), Real(1.0f));
      term = 2.0f * (1.0f - sqrt(1.0f - q2)) * cosine;
    } else {
      Vec3 tap_normal = unit_normal(load_normal(column, row), tap);
      Real behind = area_behind(area, tap, tap_normal, depth);
      Real facing = dot(to_tap, tap_normal) * one_over * -1.0f;
      facing = max(facing, facing * -C.behind);
      term = behind * facing * cosine / mad(distance2, Real(3.14159265f), behind);
    }
    Bool counts = in_picture && is_surface(tap_depth) && distance2 < C.near_radius2 && distance2 < kMaxDistance2;
    sum = sum + select(counts, term, Real(0.0f));
    inside = inside + select(in_picture, Real(1.0f), Real(0.0f));
  }
  // Samples outside the picture are unknown: those inside stand for them.
  Real occlusion = sum * (float(C.samples) / max(inside, Real(1.0f)));
  return clamp(occlusion, Real(0.0f), Real(1.0f));
}
