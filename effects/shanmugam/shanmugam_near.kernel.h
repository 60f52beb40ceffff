// The near part of `shanmugam`: pixels in a disc of near_radius, at uniform distances from one pixel on, each of which
// stands for its part of the ring of pixels at its distance. Functions in the kernel dialect; the kernel includes this
// file.

// Cosine and sine of the golden angle, by which each sample is rotated against the one before it.
CONST float kGoldenCos = -0.737368878f;
CONST float kGoldenSin = 0.675490294f;
// Min cosine between a surface and the view ray, so that the surface behind a pixel stays finite.
CONST float kMinFacing = 0.05f;
// Part of a disc's own area that is added to pi d^2. 1 would be exact for a disc right above; less is closer to the
// truth for few samples, since a wall's nearest part counts most, and noisier.
CONST float kSoftening = 0.25f;
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

// Returns the view-space position at the centre of the pixel with these coordinates, which are integers.
FN Vec3 position_at(Real x, Real y, Real depth) {
  Real spread = F.orthographic != 0 ? Real(1.0f) : depth;
  return Vec3(mad(x + 0.5f, Real(F.ray_scale_x), Real(F.ray_offset_x)) * spread,
              mad(y + 0.5f, Real(F.ray_scale_y), Real(F.ray_offset_y)) * spread, -depth);
}

// Returns what a disc hides: the surface `area` / facing behind the pixels that a sample stands for, exact on a plane.
// `area` is their own at the depth of the tap. `squared` and `one_over` are of the distance from the receiver.
FN Real hidden_by_disc(Real area, Vec3 tap, Vec3 tap_normal, Vec3 to_tap, Real squared, Real one_over) {
  Real spread = F.orthographic != 0 ? Real(1.0f) : -tap.z;
  Real facing = F.orthographic != 0 ? tap_normal.z : -dot(tap, tap_normal);  // times spread
  facing = max(facing, spread * kMinFacing);
  Real to_receiver = dot(to_tap, tap_normal) * one_over * -1.0f;
  to_receiver = max(to_receiver, to_receiver * -C.behind);
  Real scaled = area * spread;
  return scaled * to_receiver / mad(squared * 3.14159265f, facing, scaled * kSoftening);
}

// Returns the fraction of the hemisphere, weighted by cosine, that the samples in the disc hide; 0 to 1. Normals
// that are NaN or 0 hide nothing.
FN Real near_occlusion(Int px, Int py, Real depth, Vec3 position, Vec3 normal) {
  Vec2 noise = noise_at(px, py);
  Vec2 direction = direction_of_turn(noise.x);
  Real spread = F.orthographic != 0 ? Real(1.0f) : depth;
  Real radius_px = clamp(Real(C.radius_px) / spread, Real(0.0f), Real(1e5f));
  Real center_x = to_real(px) + 0.5f;
  Real center_y = to_real(py) + 0.5f;
  Real one_over_depth = 1.0f / depth;
  // A nearer sample would be in the receiver's own pixel.
  Real first_px = min(Real(1.0f), radius_px * 0.5f);
  Real area_per_px =
      (radius_px - first_px) / max(radius_px * radius_px, Real(1e-20f)) * (2.0f * C.near_area * C.one_over_samples);
  Real sum = Real(0.0f);
  Real whole = Real(0.0f);  // sums of distances, which samples count by: of all samples, and of those in the picture
  Real inside = Real(0.0f);
  for (int i = 0; i < C.samples; ++i) {
    Real offset_px = mad((float(i) + noise.y) * C.one_over_samples, radius_px - first_px, first_px);
    Real x = mad(direction.x, offset_px, center_x);
    Real y = mad(direction.y * C.rows_per_column, offset_px, center_y);
    direction = Vec2(mad(direction.x, Real(kGoldenCos), direction.y * -kGoldenSin),
                     mad(direction.x, Real(kGoldenSin), direction.y * kGoldenCos));
    Bool in_picture = x >= Real(0.0f) && y >= Real(0.0f) && x < Real(float(F.width)) && y < Real(float(F.height));
    Real column = floor(clamp(x, Real(0.0f), Real(float(F.width) - 0.5f)));
    Real row = floor(clamp(y, Real(0.0f), Real(float(F.height) - 0.5f)));
    Int place = place_of(column, row);
    Real tap_depth = read_depth(place);
    Vec3 tap = position_at(column, row, tap_depth);
    Vec3 to_tap = tap - position;
    Real distance2 = dot(to_tap, to_tap);
    Real one_over = rsqrt(max(distance2, Real(1e-30f)));
    Real cosine = mad(dot(to_tap, normal), one_over, Real(-C.bias));
    Bool counts = in_picture && is_surface(tap_depth) && cosine > Real(0.0f) && distance2 < C.near_radius2 &&
                  distance2 < kMaxDistance2;
    if (some(counts)) {
      Real ratio = F.orthographic != 0 ? Real(1.0f) : tap_depth * one_over_depth;
      Real area = ratio * ratio * (offset_px * area_per_px);
      Real hides = Real(0.0f);
      if (C.sphere != 0) {
        Real q2 = min(area * 0.318309886f * (one_over * one_over), Real(1.0f));
        hides = 2.0f * (1.0f - sqrt(1.0f - q2));
      } else {
        hides = hidden_by_disc(area, tap, read_normal(place), to_tap, distance2, one_over);
        counts = counts && is_finite(hides);
        hides = min(hides, Real(1.0f));  // a surface in one direction hides no more than the cosine there
      }
      sum = sum + select(counts, hides * cosine, Real(0.0f));
    }
    whole = whole + offset_px;
    inside = inside + select(in_picture, offset_px, Real(0.0f));
  }
  // Samples outside the picture are unknown: those inside stand for them.
  Real occlusion = sum * (whole / max(inside, Real(1e-6f)));
  return clamp(occlusion, Real(0.0f), Real(1.0f));
}
