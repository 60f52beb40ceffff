// Functions that all kernels share, in the kernel dialect. F is the FrameConstants of the picture.

// Declarations for texts that are several kernels: macros of the kernel give the flags, 0 or 1, and the names of
// planes. IN_REAL_AS declares the plane whose name is the macro `plane`, as near_LOCAL(i, j), and OUT_REAL_AS as
// store_LOCAL(v). With the flag 0, those that end in _IF declare no plane: near_LOCAL and read_NAME_of return 0, and
// store_LOCAL does nothing.
#define UMBRAGE_NEAR_AS(type, local, plane) \
  FN type near_##local(int i, int j) { return near_##plane(i, j); }
#define UMBRAGE_STORE_AS(type, local, plane) \
  FN void store_##local(type v) { store_##plane(v); }
#define IN_REAL_AS(local, plane) IN_REAL(plane) UMBRAGE_NEAR_AS(Real, local, plane)
#define OUT_REAL_AS(local, plane) OUT_REAL(plane) UMBRAGE_STORE_AS(Real, local, plane)
#define UMBRAGE_IF(flag, declaration) UMBRAGE_IF_PASTE(flag, declaration)
#define UMBRAGE_IF_PASTE(flag, declaration) declaration##flag
#define UMBRAGE_IN_COLOR_1(local, plane) IN_COLOR(plane) UMBRAGE_NEAR_AS(Vec3, local, plane)
#define UMBRAGE_IN_COLOR_0(local, plane) \
  FN Vec3 near_##local(int i, int j) { return Vec3(Real(0.0f), Real(0.0f), Real(0.0f)); }
#define UMBRAGE_OUT_COLOR_1(local, plane) OUT_COLOR(plane) UMBRAGE_STORE_AS(Vec3, local, plane)
#define UMBRAGE_OUT_VECTOR_1(local, plane) OUT_VECTOR(plane) UMBRAGE_STORE_AS(Vec3, local, plane)
#define UMBRAGE_OUT_COLOR_0(local, plane) \
  FN void store_##local(Vec3 v) {}
#define UMBRAGE_OUT_VECTOR_0(local, plane) UMBRAGE_OUT_COLOR_0(local, plane)
#define UMBRAGE_LAYERS_1(name) IN_LAYERS_REAL(name)
#define UMBRAGE_LAYERS_0(name) \
  FN Real read_##name##_of(int layer, Int place) { return Real(0.0f); }
#define UMBRAGE_FURTHER_1(name) IN_LAYERS_REAL(name)
#define UMBRAGE_FURTHER_0(name) IN_REAL(name) UMBRAGE_LAYERS_0(name)
#define IN_COLOR_IF(flag, local, plane) UMBRAGE_IF(flag, UMBRAGE_IN_COLOR_)(local, plane)
#define OUT_COLOR_IF(flag, local, plane) UMBRAGE_IF(flag, UMBRAGE_OUT_COLOR_)(local, plane)
#define OUT_VECTOR_IF(flag, local, plane) UMBRAGE_IF(flag, UMBRAGE_OUT_VECTOR_)(local, plane)
#define IN_LAYERS_REAL_IF(flag, name) UMBRAGE_IF(flag, UMBRAGE_LAYERS_)(name)
// The plane of the first layer, and with the flag 1 those of the others.
#define IN_REAL_AND_LAYERS_IF(flag, name) UMBRAGE_IF(flag, UMBRAGE_FURTHER_)(name)

// Returns v, or 0 where it is NaN or infinite.
FN Real finite_or_zero(Real v) { return select(is_finite(v), v, Real(0.0f)); }
FN Vec3 finite_or_zero(Vec3 v) { return Vec3(finite_or_zero(v.x), finite_or_zero(v.y), finite_or_zero(v.z)); }

// Returns v scaled to length 1; the zero vector stays zero.
FN Vec3 normalized(Vec3 v) {
  Real squared = dot(v, v);
  return v * select(squared > 1e-30f, rsqrt(max(squared, 1e-30f)), Real(0.0f));
}

// Returns whether a pixel's depth is that of a surface.
FN Bool is_surface(Real depth) { return depth > 0.0f && is_finite(depth); }

// Values of occlusion and light with a magnitude above this are treated as NaN, so that sums stay finite.
CONST float kMaxCleanValue = 1e30f;

// Returns the visibility, or 1 (unoccluded) where it is NaN or above kMaxCleanValue.
FN Real clean_ao(Real ao) { return select(abs(ao) <= kMaxCleanValue, ao, Real(1.0f)); }

// Returns the light, or 0 where it is NaN or above kMaxCleanValue.
FN Real clean_light(Real light) { return select(abs(light) <= kMaxCleanValue, light, Real(0.0f)); }
FN Vec3 clean_light(Vec3 light) { return Vec3(clean_light(light.x), clean_light(light.y), clean_light(light.z)); }

// Returns the hash of an integer: "lowbias32" [Wellons 2018].
FN Uint scrambled(Uint v) {
  v = (v ^ (v >> 16)) * Uint(0x7feb352du);
  v = (v ^ (v >> 15)) * Uint(0x846ca68bu);
  return v ^ (v >> 16);
}

// Returns n scaled to length 1, or the direction to the camera where n is 0 or NaN. Does not use rsqrt, so it rounds
// identically on every machine.
FN Vec3 unit_normal(Vec3 n, Vec3 position) {
  Real squared = dot(n, n);
  Bool usable = squared > 1e-20f && squared < 1e20f;
  Vec3 eye = F.orthographic != 0 ? Vec3(Real(0.0f), Real(0.0f), Real(1.0f)) : -position;
  n = select(usable, n, eye);
  Real length = sqrt(max(dot(n, n), Real(1e-30f)));
  return n * (Real(1.0f) / length);
}

// Returns the view-space position of the centre of pixel (x, y) at a depth.
FN Vec3 view_position(Int x, Int y, Real depth) {
  Real spread = F.orthographic != 0 ? Real(1.0f) : depth;
  Real px = mad(to_real(x) + 0.5f, Real(F.ray_scale_x), Real(F.ray_offset_x)) * spread;
  Real py = mad(to_real(y) + 0.5f, Real(F.ray_scale_y), Real(F.ray_offset_y)) * spread;
  return Vec3(px, py, -depth);
}

// Returns the unit vector from a view-space position to the camera.
FN Vec3 to_eye(Vec3 position) {
  if (F.orthographic != 0) return Vec3(Real(0.0f), Real(0.0f), Real(1.0f));
  return normalized(-position);
}

// Blends two linear values by their square roots, which approximates display encodings and perception: a black line
// halfway between two pixels looks as dark as a line on one pixel. With linear blending, each of the two pixels would
// look three quarters as bright as its surroundings.
FN Real mixed_as_square_roots(Real light, Real line, Real fraction) {
  Real root = sqrt(max(light, Real(0.0f)));
  root = mad(sqrt(line) - root, fraction, root);
  return root * root;
}
FN Vec3 mixed_as_square_roots(Vec3 light, Vec3 line, Real fraction) {
  return Vec3(mixed_as_square_roots(light.x, line.x, fraction), mixed_as_square_roots(light.y, line.y, fraction),
              mixed_as_square_roots(light.z, line.z, fraction));
}

// Converts a linear value to its sRGB encoding.
FN Real display_from_linear(Real v) {
  Real curve = mad(pow(v, Real(0.416666667f)), Real(1.055f), Real(-0.055f));
  return select(v > 0.0031308f, curve, v * 12.92f);
}
FN Vec3 display_from_linear(Vec3 v) {
  return Vec3(display_from_linear(v.x), display_from_linear(v.y), display_from_linear(v.z));
}
