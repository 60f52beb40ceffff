#include "effects/lighting/lighting.h"

#include <algorithm>
#include <cstring>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "core/effect.h"
#include "core/light_rig.h"
#include "core/reflection_map.h"
#include "kernels/lighting.h"
#include "kernels/lighting_open.h"

namespace umbrage {
namespace {

constexpr double kMaxFactor = 100.0;

const std::vector<Parameter> kLightingTable = {
    real_row("ambient", &LightingParams::ambient, {.initial = 1, .max = kMaxFactor}, "factor for ambient light"),
    real_row("diffuse", &LightingParams::diffuse, {.initial = 1, .max = kMaxFactor},
             "factor for diffuse reflection of the lights"),
    real_row("specular", &LightingParams::specular, {.initial = 1, .max = kMaxFactor},
             "factor for highlights and reflections; 0 also saves the computation of highlights without a roughness"),
    real_row("emission", &LightingParams::emission, {.initial = 1, .max = kMaxFactor},
             "factor for the emission of surfaces; with material=clay there is none"),
    real_row("gloss", &LightingParams::gloss, {.max = 1, .zero_means = "off"},
             "peak of a broad highlight of parallel lights, as of matt varnish, on surfaces without a higher one"),
    real_row("shadow", &LightingParams::shadow, {.initial = 1, .max = 1, .factor = "shadow_strength"},
             "darkness of shadows; at 0 none is traced"),
    choice_row(
        "material", &LightingParams::material, 0, {"scene", "clay", "display"},
        "the scene's materials, white clay without highlights, or the scene's with its albedo as a display shows it "
        "(for output.transfer=none)"),
    bool_row(
        "open", &LightingParams::open, false,
        "also write `open_light`, the brightness of an unoccluded and unshadowed white surface, for the effect ground"),
    choice_row("rig", &LightingParams::rig, 0, {"scene", "head", "key"},
               "the scene's lights; or one light without shadow, at the camera or parallel from above and to the left "
               "of the camera"),
};

/// Sets what shades surfaces with a roughness.
void set_reflections(const LightingParams& params, const PictureInfo& info, const LightRig& rig, LightingConstants& c) {
  static_assert(kLightingReflectionLevels == kReflectionLevels && kLightingReflectionTexels == kReflectionTexels &&
                kLightingBrdfSide == EnvironmentBrdf::kSide);
  c.reflection = params.ambient * params.specular;
  // The map of an environment image is in world space, one of ambient light is made in view space.
  const bool image = info.reflections && Rig(params.rig) == Rig::kScene;
  const glm::mat3 to_map = image ? glm::transpose(glm::mat3(info.camera.view_from_world)) : glm::mat3(1.0f);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) c.to_map[3 * row + column] = to_map[column][row];
  const ReflectionMap map = image ? *info.reflections : reflection_map(rig.ambient, rig.ambient_shape);
  static_assert(sizeof map == sizeof c.reflections);
  std::memcpy(c.reflections, map.data(), sizeof map);
  for (int level = 0; level < kReflectionLevels; ++level) {
    c.level_first[level] = first_reflection_texel(level);
    c.level_side[level] = kReflectionSides[std::size_t(level)];
  }
  const EnvironmentBrdf& brdf = environment_brdf();
  std::copy(brdf.scale.begin(), brdf.scale.end(), c.brdf_scale);
  std::copy(brdf.bias.begin(), brdf.bias.end(), c.brdf_bias);
}

void fill_lighting(const LightingParams& params, const PictureInfo& info, LightingConstants& c) {
  c.clay = params.material == 1 ? 1 : 0;
  c.display = params.material == 2 ? 1 : 0;
  c.diffuse = params.diffuse;
  c.specular = params.specular;
  c.gloss = params.material != 1 ? params.gloss : 0.0f;        // clay has no highlights
  c.emission = params.material != 1 ? params.emission : 0.0f;  // clay does not emit light
  const LightRig rig = light_rig(Rig(params.rig), info);
  c.ambient_r = rig.ambient.r * params.ambient;
  c.ambient_g = rig.ambient.g * params.ambient;
  c.ambient_b = rig.ambient.b * params.ambient;
  c.shaped = rig.ambient_shape.even() ? 0 : 1;
  for (int color = 0; color < 3; ++color) {
    const glm::mat4 m = rig.ambient_shape.by_color[color] * params.ambient;
    // Off-diagonal elements occur twice in the quadratic form.
    const float factors[kLightingShape] = {2.0f * m[0][3], 2.0f * m[1][3], 2.0f * m[2][3],
                                           2.0f * m[0][1], 2.0f * m[1][2], 2.0f * m[2][0],
                                           m[0][0],        m[1][1],        m[2][2]};
    std::copy_n(factors, kLightingShape, color == 0 ? c.shape_r : color == 1 ? c.shape_g : c.shape_b);
  }
  c.shadow = rig.shadows ? params.shadow : 0.0f;
  static_assert(kLightingMaxLights == kMaxRigLights);
  c.light_count = int(rig.lights.size());
  for (int k = 0; k < c.light_count; ++k) {
    const RigLight& light = rig.lights[k];
    set_place(light, k, c);
    c.r[k] = light.color.r;
    c.g[k] = light.color.g;
    c.b[k] = light.color.b;
    c.reach_squared[k] = light.reach_squared;
    c.size[k] = light.size;
  }
  c.rough = info.has_roughness && params.material != 1 ? 1 : 0;  // clay has none
  c.map_ao = info.has_material_ao && params.material != 1 ? 1 : 0;
  if (c.rough != 0) set_reflections(params, info, rig, c);
}

}  // namespace

Effect effect_lighting() {
  return shading_effect<fill_lighting>(
      kLightingTable,
      {.name = "lighting",
       .summary = "shading from the G-buffer, by metalness and roughness or Blinn-Phong, with direct and ambient light "
                  "separate",
       .source = "Blinn 1977",
       .neutral = {{"open_light", 0.0f}, {"direct", 0.0f}, {"ambient", 0.0f}},
       .dispatches = {{.inputs = {"depth",      "normal.x",   "normal.y",  "normal.z",  "albedo.r",   "albedo.g",
                                  "albedo.b",   "specular",   "shininess", "shadow",    "shadow1",    "shadow2",
                                  "shadow3",    "shadow4",    "shadow5",   "shadow6",   "shadow7",    "emission.r",
                                  "emission.g", "emission.b", "metallic",  "roughness", "material_ao"},
                       .outputs = {"direct.r", "direct.g", "direct.b", "ambient.r", "ambient.g", "ambient.b"},
                       .kernel = lighting_kernel(),
                       .reach = own_pixel},
                      {.name = "lighting_open",
                       .inputs = {"depth", "normal.x", "normal.y", "normal.z"},
                       .outputs = {"open_light"},
                       .kernel = lighting_open_kernel(),
                       .needed = [](const ParameterBytes& bytes) { return as<LightingParams>(bytes).open != 0; },
                       .reach = own_pixel}}});
}

}  // namespace umbrage
