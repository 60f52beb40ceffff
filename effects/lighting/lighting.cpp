#include "effects/lighting/lighting.h"

#include <algorithm>
#include <cstddef>
#include <glm/geometric.hpp>

#include "core/effect.h"
#include "machine/kernel_frame.h"

namespace umbrage {

UMBRAGE_DECLARE_KERNEL(lighting)

namespace {

constexpr std::uint32_t kSpirv[] = {
#include "spirv/lighting.inc"
};

constexpr double kMostFactor = 100.0;

const std::vector<Parameter> kTable = {
    {.name = "ambient",
     .help = "factor on the light from everywhere",
     .offset = offsetof(LightingParams, ambient),
     .initial = 1.0,
     .most = kMostFactor},
    {.name = "diffuse",
     .help = "factor on diffuse reflection of the lights",
     .offset = offsetof(LightingParams, diffuse),
     .initial = 1.0,
     .most = kMostFactor},
    {.name = "specular",
     .help = "factor on highlights",
     .offset = offsetof(LightingParams, specular),
     .initial = 1.0,
     .most = kMostFactor},
    {.name = "shadow",
     .help = "how dark the key light's shadow is",
     .offset = offsetof(LightingParams, shadow),
     .initial = 1.0,
     .most = 1.0},
    {.name = "material",
     .help = "the scene's materials, or white clay without highlights",
     .type = ParameterType::kChoice,
     .offset = offsetof(LightingParams, material),
     .choices = {"scene", "clay"}},
    {.name = "rig",
     .help = "the scene's lights, one light at the eye, or one parallel light from above and to the left of the camera",
     .type = ParameterType::kChoice,
     .offset = offsetof(LightingParams, rig),
     .choices = {"scene", "head", "key"}},
};

void fill_constants(const ParameterBytes& bytes, const PictureInfo& info, void* out) {
  const auto& params = as<LightingParams>(bytes);
  auto& c = *static_cast<LightingConstants*>(out);
  c = {};
  c.clay = params.material;
  c.ambient_r = info.ambient.r * params.ambient;
  c.ambient_g = info.ambient.g * params.ambient;
  c.ambient_b = info.ambient.b * params.ambient;
  c.diffuse = params.diffuse;
  c.specular = params.specular;
  c.shadow = params.shadow;

  std::vector<Light> lights = info.lights;
  if (params.rig != 0) {
    // The light of [Chamberlin 2011]: ambient 0.3 and diffuse 0.7, so that white seen head on is white.
    constexpr float kAmbient = 0.3f, kLight = 0.7f;
    const glm::vec3 above_left = glm::normalize(glm::vec3(-0.45f, 0.65f, 0.62f));
    const LightKind kind = params.rig == 1 ? LightKind::kHead : LightKind::kDirectional;
    lights.assign(1, Light{.kind = kind, .direction = above_left, .color = glm::vec3(kLight)});
    c.ambient_r = c.ambient_g = c.ambient_b = kAmbient * params.ambient;
    c.shadow = 0.0f;  // the captured shadow is another light's
  }
  c.light_count = std::min(int(lights.size()), kLightingMostLights);
  for (int k = 0; k < c.light_count; ++k) {
    const Light& light = lights[k];
    // A head light is parallel along the view axis for an orthographic camera and a point at the eye otherwise.
    const bool head = light.kind == LightKind::kHead;
    const bool point = light.kind == LightKind::kPoint || (head && info.camera.projection == Projection::kPerspective);
    const glm::vec3 where =
        head ? (point ? glm::vec3(0.0f) : glm::vec3(0.0f, 0.0f, 1.0f)) : (point ? light.position : light.direction);
    c.kind[k] = point ? 1 : 0;
    c.x[k] = where.x;
    c.y[k] = where.y;
    c.z[k] = where.z;
    c.r[k] = light.color.r;
    c.g[k] = light.color.g;
    c.b[k] = light.color.b;
    c.reach_squared[k] = head ? 0.0f : light.reach * light.reach;
  }
}

}  // namespace

const Effect& effect_lighting() {
  static const Effect effect = {
      .name = "lighting",
      .summary = "Lambert and Blinn-Phong light from the G-buffer, direct and ambient apart",
      .source = "Blinn 1977",
      .kind = EffectKind::kShading,
      .parameters = kTable,
      .params_size = sizeof(LightingParams),
      .constants_size = sizeof(LightingConstants),
      .constants = fill_constants,
      .passes = {{.name = "lighting",
                  .inputs = {"depth", "normal.x", "normal.y", "normal.z", "albedo.r", "albedo.g", "albedo.b",
                             "specular", "shininess", "shadow"},
                  .outputs = {"direct.r", "direct.g", "direct.b", "ambient.r", "ambient.g", "ambient.b"},
                  .scalar = run_scalar_lighting,
                  .lanes = run_lanes_lighting,
                  .spirv = kSpirv}},
  };
  return effect;
}

}  // namespace umbrage
