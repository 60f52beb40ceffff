#include "renderer/shade.h"

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "core/reflection_map.h"
#include "effects/normals/normals.h"
#include "renderer/drawing.h"

namespace umbrage {
namespace {

/// Uploads a G-buffer and reconstructs missing normals.
Result<Frame> upload_with_normals(Device& device, GBuffer gbuffer, const EffectSettings& settings) {
  std::vector<bool> has_normals;
  for (const Image& layer : gbuffer.layers) has_normals.push_back(layer.find("normal.x") != nullptr);
  auto frame = device.upload(std::move(gbuffer));
  if (!frame) return frame;
  const Effect& normals = effect_with<NormalsParams>();
  for (std::size_t layer = 0; layer < has_normals.size(); ++layer)
    if (!has_normals[layer])
      if (auto status = device.run(normals, params_of(settings, normals.name), *frame, {.layer = int(layer)}); !status)
        return status.error();
  return frame;
}

/// Places the default lights of a look for a G-buffer, in view space, where they do not depend on the camera's
/// position.
void place_default_lights(const Recipe& recipe, PictureInfo& info) {
  Camera at_origin = info.camera;
  at_origin.view_from_world = glm::mat4(1.0f);
  // Seen from above, the vertical points towards the camera.
  const glm::vec3 up = recipe.from_above ? glm::vec3(0.0f, 0.0f, 1.0f) : glm::vec3(0.0f, 1.0f, 0.0f);
  const bool studio = recipe.look->studio_lights;
  const Lighting lighting = studio ? studio_lighting(at_origin, up) : default_lighting(at_origin, up);
  info.lights = lighting.lights;
  if (recipe.from_above) info.lights.resize(1);  // the fill and the rim light would fill its shadows with other slopes
  info.ambient = lighting.ambient;
  info.ambient_shape = lighting.ambient_shape;
  const glm::mat3 world_from_view = glm::transpose(glm::mat3(info.camera.view_from_world));
  if (studio && info.has_roughness) info.reflections = studio_reflections(world_from_view[1]);
  adjust_lights(recipe, at_origin, studio, info.lights);
}

}  // namespace

Result<Recipe> complete_shading(const Recipe& requested, PictureInfo& info) {
  Recipe recipe = requested;
  if (info.lights.empty() && !recipe.effects_look) place_default_lights(recipe, info);
  if (recipe.radius) {
    const auto radius = radius_in_scene("`occlusion_radius`", *recipe.radius, info);
    if (!radius) return with_field(radius.error(), "occlusion_radius");
    apply_radius(*radius, info, recipe);
  }
  return recipe;
}

Result<Drawn> shade_planes(Device& device, GBuffer gbuffer, const Recipe& requested, StageTimes& times,
                           const ProgressMonitor& monitor, std::optional<float> stops) {
  gbuffer.info = info_of(gbuffer);
  const auto recipe = complete_shading(requested, gbuffer.info);
  if (!recipe) return recipe.error();
  DrawProgress progress(monitor, 1 + recipe->look->effects.size());
  auto frame = upload_with_normals(device, std::move(gbuffer), recipe->settings);
  if (!frame) return frame.error();
  progress.step_done();
  times.done("upload");
  LookRun run = look_run(*recipe);
  report_to(progress, times, run);
  run.stops = stops;
  const auto state = run_look(run, device, *frame);
  if (!state) return state.error();
  if (auto ended = progress.end(); !ended) return ended.error();
  return Drawn{std::move(*frame), state->stops};
}

}  // namespace umbrage
