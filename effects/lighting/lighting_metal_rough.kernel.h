// Reflection by the metallic-roughness material of glTF 2.0, appendix B: GGX with height-correlated masking, Schlick's
// Fresnel term, and Lambert's diffuse term. Surroundings are reflected by the split-sum approximation [Karis 2013].
// Differs: as everywhere in this effect, nothing is divided by pi.

CONST float kDielectricReflectance = 0.04f;
CONST float kMinAlpha = 0.002f;      // a narrower lobe is a point even on a large picture
CONST float kMinCosine = 1e-4f;      // between normal and camera: keeps quotients finite
CONST float kMeanGrazing = 0.0293f;  // fit to the mean of (1 - V.H)^5 under uniform light, over (1 - N.V)^3

// A surface and its material.
struct Finish {
  Vec3 normal, eye, mirrored;  // mirrored: the direction that a mirror would show
  Vec3 diffuse, reflectance;   // reflectance at normal incidence
  Real roughness, alpha, cosine;
};

FN Real power5(Real v) { return v * v * (v * v) * v; }
FN Vec3 gray_of(Real v) { return Vec3(v, v, v); }

FN Finish finish_of(Vec3 normal, Vec3 eye, Vec3 base, Real metallic, Real roughness) {
  Real rough = clamp(roughness, Real(0.0f), Real(1.0f));
  Real metal = clamp(metallic, Real(0.0f), Real(1.0f));
  Real facing = dot(normal, eye);
  return Finish(normal, eye, normal * (facing * 2.0f) - eye, base * (Real(1.0f) - metal),
                base * metal + gray_of((Real(1.0f) - metal) * kDielectricReflectance), rough,
                max(rough * rough, Real(kMinAlpha)), max(facing, Real(kMinCosine)));
}

// Returns the radiance under a light of radiance 1 on white. `lambert`: cosine of the light's centre, at least 0; `sine`:
// of the angular radius of the light. A disc is replaced by its point nearest to the mirrored direction [Karis 2013,
// "Spherical Area Lights"], which may be above the horizon when the centre is not. The lobe's energy is kept as in Unreal
// Engine's BRDF.ush, but for a disc that half vectors stretch by 1 / V.H across the plane of incidence alone.
FN Vec3 reflected_light(Finish f, Vec3 light, Real lambert, Real sine) {
  Vec3 off = f.mirrored * dot(light, f.mirrored) - light;
  Real fraction = min(sine * rsqrt(max(dot(off, off), Real(1e-12f))), Real(1.0f));
  Vec3 toward = normalized(light + off * fraction);
  Vec3 halfway = normalized(toward + f.eye);
  Vec3 across = cross(f.normal, halfway);
  Real nl = max(dot(f.normal, toward), Real(0.0f));
  Real nh = dot(f.normal, halfway);
  Real vh = max(dot(f.eye, halfway), Real(0.0f));
  Real a2 = f.alpha * f.alpha;
  Real spread = mad(a2, nh * nh, dot(across, across));
  Real stretch = Real(1.0f) / (vh + 0.001f);
  Real kept = a2 / (a2 + sine * mad(sine * stretch, Real(0.25f), f.alpha * (stretch + 1.0f) * 0.375f));
  Real masking =
      nl * sqrt(mad(f.cosine * f.cosine, Real(1.0f) - a2, a2)) + f.cosine * sqrt(mad(nl * nl, Real(1.0f) - a2, a2));
  Real lobe = a2 * kept * nl * 0.5f / max(spread * spread * masking, Real(1e-30f));
  Real grazing = power5(Real(1.0f) - vh);
  Vec3 fresnel = f.reflectance + (gray_of(Real(1.0f)) - f.reflectance) * grazing;
  // The diffuse part is that of the dielectric, whatever the metal reflects.
  Real refracted = (Real(1.0f) - grazing) * (1.0f - kDielectricReflectance);
  return f.diffuse * (refracted * lambert * Real(C.diffuse)) + fresnel * (lobe * Real(C.specular));
}

FN Vec3 reflection_texel(Int index) {
  Uint bits = to_uint(entry_of(C.reflections, index));
  Real scale = real_of_bits(((bits >> 27) + Uint(103u)) << 23);  // 2^(e - 24)
  Uint mask = Uint(511u);
  return Vec3(to_real(to_signed(bits & mask)), to_real(to_signed((bits >> 9) & mask)),
              to_real(to_signed((bits >> 18) & mask))) *
         scale;
}

// Returns a level of the reflection map at a point of the octahedral map, from 0 to 1.
FN Vec3 reflection_level(Int level, Real u, Real v) {
  Int side = entry_of(C.level_side, level);
  Real x = mad(u, to_real(side), Real(0.5f));  // the border is one texel
  Real y = mad(v, to_real(side), Real(0.5f));
  Int column = min(to_int(x), side);
  Int row = min(to_int(y), side);
  Int index = entry_of(C.level_first, level) + row * (side + Int(2)) + column;
  Real fx = x - to_real(column);
  Real fy = y - to_real(row);
  Vec3 top = reflection_texel(index);
  top = top + (reflection_texel(index + Int(1)) - top) * fx;
  Int below = index + side + Int(2);
  Vec3 bottom = reflection_texel(below);
  bottom = bottom + (reflection_texel(below + Int(1)) - bottom) * fx;
  return top + (bottom - top) * fy;
}

// Returns the light from around the mirrored direction, averaged over the lobe.
FN Vec3 reflection_of(Finish f) {
  Vec3 m = f.mirrored;
  Vec3 d = Vec3(dot(m, Vec3(Real(C.to_map[0]), Real(C.to_map[1]), Real(C.to_map[2]))),
                dot(m, Vec3(Real(C.to_map[3]), Real(C.to_map[4]), Real(C.to_map[5]))),
                dot(m, Vec3(Real(C.to_map[6]), Real(C.to_map[7]), Real(C.to_map[8]))));
  Real size = max(abs(d.x) + abs(d.y) + abs(d.z), Real(1e-20f));
  Real x = d.x / size;
  Real y = d.y / size;
  Real folded_x = (Real(1.0f) - abs(y)) * select(x < 0.0f, Real(-1.0f), Real(1.0f));
  Real folded_y = (Real(1.0f) - abs(x)) * select(y < 0.0f, Real(-1.0f), Real(1.0f));
  Bool lower = d.z < 0.0f;
  Real u = clamp(mad(select(lower, folded_x, x), Real(0.5f), Real(0.5f)), Real(0.0f), Real(1.0f));
  Real v = clamp(mad(select(lower, folded_y, y), Real(0.5f), Real(0.5f)), Real(0.0f), Real(1.0f));
  Real level = f.roughness * float(kLightingReflectionLevels - 1);
  Int fine = min(to_int(level), Int(kLightingReflectionLevels - 2));
  Vec3 sharp = reflection_level(fine, u, v);
  return sharp + (reflection_level(fine + Int(1), u, v) - sharp) * (level - to_real(fine));
}

// Returns the scale (x) and bias (y) of the reflectance under uniform light.
FN Vec2 environment_brdf(Finish f) {
  Real x = f.roughness * float(kLightingBrdfSide - 1);
  Real y = min(f.cosine, Real(1.0f)) * float(kLightingBrdfSide - 1);
  Int column = min(to_int(x), Int(kLightingBrdfSide - 2));
  Int row = min(to_int(y), Int(kLightingBrdfSide - 2));
  Int index = row * Int(kLightingBrdfSide) + column;
  Int below = index + Int(kLightingBrdfSide);
  Real fx = x - to_real(column);
  Real fy = y - to_real(row);
  Vec2 a = Vec2(entry_of(C.brdf_scale, index), entry_of(C.brdf_bias, index));
  Vec2 b = Vec2(entry_of(C.brdf_scale, index + Int(1)), entry_of(C.brdf_bias, index + Int(1)));
  Vec2 c = Vec2(entry_of(C.brdf_scale, below), entry_of(C.brdf_bias, below));
  Vec2 d = Vec2(entry_of(C.brdf_scale, below + Int(1)), entry_of(C.brdf_bias, below + Int(1)));
  Vec2 top = a + (b - a) * fx;
  return top + (c + (d - c) * fx - top) * fy;
}

// Returns the radiance under ambient light, whose radiance on a white surface with this normal is `ambient`.
FN Vec3 reflected_ambient(Finish f, Vec3 ambient) {
  Vec2 brdf = environment_brdf(f);
  Real away = Real(1.0f) - min(f.cosine, Real(1.0f));
  Real grazing = away * away * away * kMeanGrazing;
  Real refracted = (Real(1.0f) - grazing) * (1.0f - kDielectricReflectance);
  Vec3 reflected = reflection_of(f) * (f.reflectance * brdf.x + gray_of(brdf.y));
  return f.diffuse * ambient * refracted + reflected * Real(C.reflection);
}
