// Computes shading from the G-buffer: where there is a roughness, that of glTF 2.0, else Lambert and Blinn-Phong [Blinn
// 1977].
//
// Writes radiance as two colours, because occlusion darkens only the second: `direct` (lights and emission) and
// `ambient`. Results that are not finite become 0.
// Differs: Lambert's reflectance is not divided by pi; a light's colour is the radiance of a white surface facing it.
IN_REAL(depth)
IN_VECTOR(normal)
IN_COLOR(albedo)
IN_REAL(specular)
IN_REAL(shininess)
IN_REAL(shadow)
IN_REAL(shadow1)
IN_REAL(shadow2)
IN_REAL(shadow3)
IN_REAL(shadow4)
IN_REAL(shadow5)
IN_REAL(shadow6)
IN_REAL(shadow7)
IN_COLOR(emission)
IN_REAL(metallic)
IN_REAL(roughness)
IN_REAL(material_ao)
OUT_COLOR(direct)
OUT_COLOR(ambient)

#include "effects/lighting/lighting_ambient.kernel.h"
#include "effects/lighting/lighting_lights.kernel.h"
#include "effects/lighting/lighting_metal_rough.kernel.h"

// Half as bright where the halfway vector is 21 degrees off the normal: matt varnish.
CONST float kGlossExponent = 10.0f;

// Returns the visibility of a light, from its shadow plane; 1 for lights beyond the last plane.
FN Real shadow_of(int light) {
  if (light == 0) return near_shadow(0, 0);
  if (light == 1) return near_shadow1(0, 0);
  if (light == 2) return near_shadow2(0, 0);
  if (light == 3) return near_shadow3(0, 0);
  if (light == 4) return near_shadow4(0, 0);
  if (light == 5) return near_shadow5(0, 0);
  if (light == 6) return near_shadow6(0, 0);
  if (light == 7) return near_shadow7(0, 0);
  return Real(1.0f);
}

// Returns the light of all lights that a surface with a roughness reflects.
FN Vec3 direct_on(Finish finish, Vec3 position) {
  Vec3 sum = gray_of(Real(0.0f));
  for (int k = 0; k < C.light_count; ++k) {
    Vec3 light = towards_light(k, position);
    Real attenuation = light_falloff(k, position);
    if (C.shadow > 0.0f) attenuation = attenuation * mad(shadow_of(k) - 1.0f, Real(C.shadow), Real(1.0f));
    Vec3 color = Vec3(Real(C.r[k]), Real(C.g[k]), Real(C.b[k])) * attenuation;
    Real lambert = max(dot(finish.normal, light), Real(0.0f));
    sum = sum + color * reflected_light(finish, light, lambert, light_sine(k, position));
  }
  return sum;
}

FN void lighting_pixel(Int px, Int py) {
  Real depth = near_depth(0, 0);
  Bool surface = is_finite(depth);
  Vec3 position = view_position(px, py, select(surface, depth, Real(1.0f)));
  Vec3 eye = to_eye(position);
  Vec3 normal = near_normal(0, 0);
  Vec3 albedo = near_albedo(0, 0);
  Real strength = near_specular(0, 0) * Real(C.specular);
  Real exponent = near_shininess(0, 0);
  if (C.display != 0) albedo = display_from_linear(albedo);
  if (C.clay != 0) {
    albedo = Vec3(Real(1.0f), Real(1.0f), Real(1.0f));
    strength = Real(0.0f);
  }
  // For parallel light, matt surfaces get a broad highlight; on walls near a lamp it would be a blotch.
  Real gloss = strength;
  Real gloss_exponent = exponent;
  if (C.gloss > 0.0f) {
    Bool matt = strength < C.gloss;
    gloss = select(matt, Real(C.gloss), strength);
    gloss_exponent = select(matt, Real(kGlossExponent), exponent);
  }
  Vec3 none = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  Vec3 emission = none;
  if (C.emission > 0.0f) emission = near_emission(0, 0) * Real(C.emission);
  Vec3 sum = emission;
  for (int k = 0; k < C.light_count; ++k) {
    Vec3 light = towards_light(k, position);
    Real attenuation = light_falloff(k, position);
    if (C.shadow > 0.0f) attenuation = attenuation * mad(shadow_of(k) - 1.0f, Real(C.shadow), Real(1.0f));
    Real lambert = max(dot(normal, light), Real(0.0f));
    Real highlight = Real(0.0f);
    if (C.specular > 0.0f || C.gloss > 0.0f) {
      Vec3 halfway = normalized(light + eye);
      Real cosine = max(dot(normal, halfway), Real(0.0f));
      // Like the diffuse part, it vanishes towards the terminator, where less and less light arrives per area.
      highlight = (C.kind[k] == 1 ? strength * pow(cosine, exponent) : gloss * pow(cosine, gloss_exponent)) * lambert;
    }
    Vec3 color = Vec3(Real(C.r[k]), Real(C.g[k]), Real(C.b[k])) * attenuation;
    Vec3 white = Vec3(highlight, highlight, highlight);
    sum = sum + color * (albedo * (lambert * Real(C.diffuse)) + white);
  }
  Vec3 ambient = ambient_at_normal(normal);
  Vec3 reflected = albedo * ambient;
  if (C.rough != 0) {
    Bool rough = near_roughness(0, 0) >= 0.0f;
    if (some(rough)) {
      Finish finish = finish_of(normal, eye, albedo, near_metallic(0, 0), near_roughness(0, 0));
      sum = select(rough, emission + direct_on(finish, position), sum);
      reflected = select(rough, reflected_ambient(finish, ambient), reflected);
    }
  }
  if (C.map_ao != 0) reflected = reflected * near_material_ao(0, 0);
  store_direct(select(surface, finite_or_zero(sum), none));
  store_ambient(select(surface, finite_or_zero(reflected), none));
}
