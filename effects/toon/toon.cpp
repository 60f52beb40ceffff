#include "effects/toon/toon.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>

#include "core/effect.h"
#include "core/light_rig.h"
#include "kernel/kernel_frame.h"

namespace umbrage {

UMBRAGE_DECLARE_KERNEL(toon_light)
UMBRAGE_DECLARE_KERNEL(toon)

namespace {

constexpr std::uint32_t kLightSpirv[] = {
#include "spirv/toon_light.inc"
};
constexpr std::uint32_t kSpirv[] = {
#include "spirv/toon.inc"
};

constexpr double kMostFactor = 100.0;
constexpr double kPaperBands = 4.0, kPaperAmbient = 0.1, kPaperExtra = 0.2;  // listing 2
// Of an edge between bands, as change of intensity: fifty times what rounding changes it across a flat face, so that a
// face whose light falls on an edge is evenly coloured and not speckled. Surfaces that curve visibly change it faster.
constexpr float kLeastChange = 5e-5f;

const std::vector<Parameter> kTable = {
    {.name = "mode",
     .help = "a given number of bands in a ramp of colours, or the paper's steps of the object's colour",
     .type = ParameterType::kChoice,
     .offset = offsetof(ToonParams, mode),
     .choices = {"ramp", "paper"}},
    {.name = "bands",
     .help = "how many bands; in the paper's mode how many per unit of intensity",
     .type = ParameterType::kInt,
     .offset = offsetof(ToonParams, bands),
     .initial = kPaperBands,
     .least = 1.0,
     .most = 256.0},
    {.name = "ambient",
     .help = "intensity of light from everywhere that occlusion darkens; the key light's is 1",
     .offset = offsetof(ToonParams, ambient),
     .initial = kPaperAmbient,
     .most = kMostFactor},
    {.name = "extra",
     .help = "intensity of light from everywhere that nothing darkens",
     .offset = offsetof(ToonParams, extra),
     .initial = kPaperExtra,
     .most = kMostFactor},
    {.name = "rig",
     .help = "the scene's lights, one light at the eye, or one parallel light from above and to the left of the camera",
     .type = ParameterType::kChoice,
     .offset = offsetof(ToonParams, rig),
     .choices = {"scene", "head", "key"}},
    {.name = "shadow",
     .help = "how dark the key light's shadow is",
     .offset = offsetof(ToonParams, shadow),
     .initial = 1.0,
     .most = 1.0},
    {.name = "softness",
     .help = "width of the edge between two bands, in bands; 0: antialiased, about a pixel (ramp)",
     .offset = offsetof(ToonParams, softness),
     .most = 1.0},
    {.name = "specular",
     .help = "factor on highlights",
     .offset = offsetof(ToonParams, specular),
     .initial = 1.0,
     .most = kMostFactor},
    {.name = "highlight_size",
     .help = "factor on the diameter of highlights (ramp)",
     .offset = offsetof(ToonParams, highlight_size),
     .initial = 1.0,
     .least = 0.01,
     .most = 10.0},
    {.name = "shadow_r",
     .help = "red of the darkest band on white (ramp)",
     .offset = offsetof(ToonParams, shadow_r),
     .initial = 0.18,
     .most = 1.0},
    {.name = "shadow_g",
     .help = "green of the darkest band on white (ramp)",
     .offset = offsetof(ToonParams, shadow_g),
     .initial = 0.16,
     .most = 1.0},
    {.name = "shadow_b",
     .help = "blue of the darkest band on white (ramp)",
     .offset = offsetof(ToonParams, shadow_b),
     .initial = 0.30,
     .most = 1.0},
    {.name = "light_r",
     .help = "red of the brightest band on white, and of highlights (ramp)",
     .offset = offsetof(ToonParams, light_r),
     .initial = 1.0,
     .most = 1.0},
    {.name = "light_g",
     .help = "green of the brightest band on white, and of highlights (ramp)",
     .offset = offsetof(ToonParams, light_g),
     .initial = 1.0,
     .most = 1.0},
    {.name = "light_b",
     .help = "blue of the brightest band on white, and of highlights (ramp)",
     .offset = offsetof(ToonParams, light_b),
     .initial = 1.0,
     .most = 1.0},
    {.name = "albedo",
     .help = "the object's colour: its albedo, its albedo as a display shows it (for output.transfer=none), or white",
     .type = ParameterType::kChoice,
     .offset = offsetof(ToonParams, albedo),
     .choices = {"texture", "display", "clay"}},
};

float luminance(const glm::vec3& color) { return glm::dot(color, glm::vec3(0.2126f, 0.7152f, 0.0722f)); }

/// Where ambient light comes from, by its first harmonics.
glm::vec3 brightest_direction(const AmbientShape& shape) {
  glm::vec3 sum(0.0f);
  for (int axis = 0; axis < 3; ++axis)
    sum[axis] = luminance({shape.by_color[0][axis][3], shape.by_color[1][axis][3], shape.by_color[2][axis][3]});
  return glm::length(sum) > 0.0f ? glm::normalize(sum) : glm::vec3(0.0f);
}

void fill_lights(const ToonParams& params, const PictureInfo& info, ToonConstants& c) {
  const LightRig rig = light_rig(Rig(params.rig), info);
  if (!rig.shadows) c.shadow = 0.0f;
  // The paper has one light, which does not fall off.
  const bool paper = params.mode == kToonPaper;
  static_assert(kToonMostLights == kMostRigLights);
  c.light_count = std::min(int(rig.lights.size()), paper ? 1 : kToonMostLights);
  if (rig.lights.empty() && !rig.ambient_shape.even()) {
    // Of a sky without a sun: bands by where most of its light comes from.
    c.light_count = 1;
    c.shadow = 0.0f;
    c.share[0] = 1.0f;
    const glm::vec3 most = brightest_direction(rig.ambient_shape);
    c.x[0] = most.x;
    c.y[0] = most.y;
    c.z[0] = most.z;
    return;
  }
  const float key = rig.lights.empty() ? 0.0f : luminance(rig.lights[0].color);
  for (int k = 0; k < c.light_count; ++k) {
    const RigLight& light = rig.lights[k];
    c.kind[k] = light.point ? 1 : 0;
    c.x[k] = light.where.x;
    c.y[k] = light.where.y;
    c.z[k] = light.where.z;
    c.share[k] = k == 0 ? 1.0f : key > 0.0f ? luminance(light.color) / key : 0.0f;
    c.reach_squared[k] = paper ? 0.0f : light.reach_squared;
  }
}

void fill_constants(const ParameterBytes& bytes, const PictureInfo& info, void* out) {
  const auto& params = as<ToonParams>(bytes);
  auto& c = *static_cast<ToonConstants*>(out);
  c = {};
  c.mode = params.mode;
  c.albedo = params.albedo;
  c.bands = float(params.bands);
  c.ambient = params.ambient;
  c.extra = params.extra;
  c.shadow = params.shadow;
  c.specular = params.specular;
  // A surface that faces the key light, unoccluded, has the whole ramp's intensity. Neither it nor one that faces away
  // lies on an edge between bands.
  c.bands_per_intensity = c.bands / (1.0f + params.ambient + params.extra);
  c.inverse_bands = 1.0f / c.bands;
  c.least_width = std::min(kLeastChange * c.bands_per_intensity, 1.0f);
  c.softness = params.softness;
  constexpr float kSpeckHeight = 432.0f, kMostSpeck = 8.0f;  // of the picture, per pixel; and pixels
  const float speck_px = std::min(std::round(float(info.inner_height()) / kSpeckHeight), kMostSpeck);
  c.speck = params.mode == kToonRamp && params.softness == 0.0f ? int(speck_px) : 0;
  c.sharpness = 1.0f / (params.highlight_size * params.highlight_size);
  const bool flat = params.bands == 1;
  const float steps = std::max(c.bands - 1.0f, 1.0f);
  c.light_r = params.light_r;
  c.light_g = params.light_g;
  c.light_b = params.light_b;
  c.shadow_r = flat ? params.light_r : params.shadow_r;
  c.shadow_g = flat ? params.light_g : params.shadow_g;
  c.shadow_b = flat ? params.light_b : params.shadow_b;
  c.step_r = (params.light_r - c.shadow_r) / steps;
  c.step_g = (params.light_g - c.shadow_g) / steps;
  c.step_b = (params.light_b - c.shadow_b) / steps;
  fill_lights(params, info, c);
}

/// Shadows look at the pixels beside,
int light_reach(const void*, int) { return 1; }
/// and bands, also as far as specks are wide.
int bands_reach(const void* constants, int) { return std::max(static_cast<const ToonConstants*>(constants)->speck, 1); }

}  // namespace

const Effect& effect_toon() {
  static const Effect effect = {
      .name = "toon",
      .summary = "toon bands of light, with antialiased edges, coloured shadows and round highlights",
      .source = "Lajzer and Nottingham",
      .kind = EffectKind::kShading,
      .parameters = kTable,
      .params_size = sizeof(ToonParams),
      .constants_size = sizeof(ToonConstants),
      .constants = fill_constants,
      .variants = {"", "mode=paper"},
      .quantum = 1.0 / kPaperBands,
      .passes = {{.name = "light",
                  .inputs = {"depth", "normal.x", "normal.y", "normal.z", "specular", "shininess", "shadow", "ao"},
                  .outputs = {"toon_intensity", "toon_highlight"},
                  .scalar = run_scalar_toon_light,
                  .lanes = run_lanes_toon_light,
                  .spirv = kLightSpirv,
                  .reach = light_reach},
                 {.name = "bands",
                  .inputs = {"depth", "normal.x", "normal.y", "normal.z", "toon_intensity", "toon_highlight",
                             "albedo.r", "albedo.g", "albedo.b", "specular"},
                  .outputs = {"lit.r", "lit.g", "lit.b"},
                  .scalar = run_scalar_toon,
                  .lanes = run_lanes_toon,
                  .spirv = kSpirv,
                  .reach = bands_reach}},
  };
  return effect;
}

}  // namespace umbrage
