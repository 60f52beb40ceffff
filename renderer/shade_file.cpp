#include "renderer/shade_file.h"

#include <algorithm>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>

#include "core/reflection_map.h"
#include "effects/bitmask/bitmask.h"
#include "effects/normals/normals.h"
#include "effects/output/output.h"
#include "effects/relight/relight.h"
#include "renderer/drawing.h"
#include "renderer/strip_drawer.h"
#include "renderer/strokes.h"

namespace umbrage {
namespace {

/// Returns the source of the strips of a file, without frames. Missing normals are reconstructed from depth.
StripSource source_of(const GBufferFile& file, const Recipe& recipe, const PictureInfo& info) {
  StripSource source{.run = look_run(recipe),
                     .info = info,
                     .lines = stroke_parameters_or_none(recipe),
                     .given = {file.plane_names(), {}}};
  const Effect& normals = effect_with<NormalsParams>();
  if (!file.has_plane("normal.x")) source.before.push_back({&normals, params_of(recipe.settings, normals.name)});
  return source;
}

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

Result<StripSizes> plan_file_strips(const Device& device, const GBufferFile& file, const Recipe& recipe,
                                    std::optional<double> memory) {
  const double pixels = double(file.info().width) * file.info().height;
  const double stored = file.is_in_memory() ? double(file.plane_names().size() * sizeof(float)) * pixels : 0.0;
  return plan_strips(device, source_of(file, recipe, file.info()), {}, memory.value_or(file.memory() - stored));
}

Result<SequenceStart> shade_strips(Device& device, const GBufferFile& file, const Recipe& requested, int rows,
                                   const std::vector<std::string>& planes, const TakeRows& take,
                                   const std::optional<SequenceStart>& start, StageTimes& times,
                                   const ProgressMonitor& monitor) {
  PictureInfo info = started(file.info(), start);
  info.has_roughness = file.has_plane("roughness");
  info.has_material_ao = file.has_plane("material_ao");
  const auto recipe = complete_shading(requested, info);
  if (!recipe) return recipe.error();
  StripSource source = source_of(file, *recipe, info);
  DrawProgress progress(monitor, 1 + recipe->look->effects.size());
  source.make_frame = [&, before = source.before](const Strip& strip) -> Result<Frame> {
    auto read = file.rows(rows_with_margin(strip, info.height));
    if (!read) return read.error();
    times.done("read");
    GBuffer gbuffer{.info = info, .layers = {}};
    gbuffer.layers.push_back(std::move(*read));
    auto frame = device.upload(std::move(gbuffer), &strip);
    if (!frame) return frame;
    for (const EffectStep& step : before)
      if (auto status = device.run(*step.effect, step.params, *frame, {}, progress.step_monitor()); !status)
        return status.error();
    times.done("upload");
    progress.step_done();
    return frame;
  };
  if (start) source.run.stops = start->stops;
  StripDrawer drawer(device, std::move(source), rows, progress, times);
  const auto finish = [&](const Frame& frame, Image& part, int first) { return take(frame.info, part, first); };
  if (auto status = drawer.draw_picture(planes, false, finish); !status) return status.error();
  if (auto ended = progress.end(); !ended) return ended.error();
  return start_of(info, drawer.stops());
}

namespace {

/// Checks that the file has the picture that the look changes. Errors: kUsage.
Result<void> check_beauty(const Recipe& recipe, const GBufferFile& file) {
  if (!recipe.look->needs_beauty || file.has_plane("beauty.r")) return {};
  return field_error(
      "look", recipe.look->name,
      "the {0} '{1}' needs the renderer's own picture, which this file lacks: it takes `beauty_file`, or "
      "another `{0}`");
}

/// Checks that the reduced picture has a pixel, and stores the factor. Errors: kUsage.
Result<void> resolve_reduction(const Request& request, Recipe& recipe) {
  recipe.reduction = request.gbuffer.reduction;
  if (std::min(recipe.width, recipe.height) >= recipe.reduction) return {};
  return field_error("reduction", recipe.reduction, "`{}` cannot be '{}': the picture has {} x {} pixels", recipe.width,
                     recipe.height);
}

/// Treats an elevation model as maps do: it is solid, and lit from the north-west, which is the upper left, 45 degrees
/// high; unless the request sets these.
void shade_as_relief(Recipe& recipe) {
  constexpr glm::vec2 kNorthWestDeg(-35.2644f, 30.0f);  // towards (-1, 1, sqrt 2), as azimuth and elevation in the view
  recipe.from_above = true;
  if (!recipe.framing.light_deg) recipe.framing.light_deg = kNorthWestDeg;
  if (!is_set<BitmaskParams>(recipe, "mode")) params_of<BitmaskParams>(recipe.settings).mode = kBitmaskInfinite;
}

}  // namespace

Result<Recipe> make_file_recipe(const Request& request, const GBufferFile& file) {
  Request of_file = request;
  of_file.width = file.info().width;
  of_file.height = file.info().height;
  if (request.look.empty() && request.effects.empty() && file.has_plane("beauty.r")) of_file.look = "comp";
  auto recipe = make_shading_recipe(of_file, kMaxStripPixels);
  if (!recipe) return recipe;
  if (auto status = check_beauty(*recipe, file); !status) return status.error();
  if (auto status = resolve_reduction(request, *recipe); !status) return status.error();
  if (file.has_plane("ambient.r") && !is_set<RelightParams>(*recipe, "source"))
    params_of<RelightParams>(recipe->settings).source = kRelightPlanes;
  if (file.depth_meaning() == DepthMeaning::kHeight) shade_as_relief(*recipe);
  return recipe;
}

PictureInfo started(PictureInfo info, const std::optional<SequenceStart>& start) {
  if (!start) return info;
  info.scene_radius = start->scene_radius;
  if (start->depth_max > start->depth_min) {
    info.depth_min = start->depth_min;
    info.depth_max = start->depth_max;
  }
  return info;
}

SequenceStart start_of(const PictureInfo& info, float stops) {
  return {info.scene_radius, stops, info.depth_min, info.depth_max};
}

Result<ShadedFile> shade_whole_file(Device& device, const GBufferFile& file, const Recipe& recipe,
                                    const std::optional<SequenceStart>& start, StageTimes& times,
                                    const ProgressMonitor& monitor) {
  auto rows = file.rows({0, file.info().height});
  if (!rows) return rows.error();
  GBuffer gbuffer{.info = started(file.info(), start), .layers = {}};
  gbuffer.layers.push_back(std::move(*rows));
  times.done("read");
  auto picture = shade_planes(device, std::move(gbuffer), recipe, times, monitor, start ? start->stops : std::nullopt);
  if (!picture) return picture.error();
  const SequenceStart used = start_of(picture->frame.info, picture->stops.value_or(0.0f));
  return ShadedFile{std::move(picture->frame), used};
}

Result<SequenceStart> shade_file(Device& device, const GBufferFile& file, const Recipe& recipe,
                                 const std::vector<std::string>& planes, const TakeRows& take,
                                 const std::optional<SequenceStart>& start, StageTimes& times,
                                 const ProgressMonitor& monitor) {
  const auto strips = plan_file_strips(device, file, recipe);
  if (!strips) return strips.error();
  const TakeRows take_reduced = reduced_rows(recipe.reduction, recipe, take);
  if (strips->rows > 0)
    return shade_strips(device, file, recipe, strips->rows, planes, take_reduced, start, times, monitor);
  const auto shaded = shade_whole_file(device, file, recipe, start, times, monitor);
  if (!shaded) return shaded.error();
  const auto picture = device.download(shaded->frame, planes);
  if (!picture) return picture.error();
  if (auto taken = take_reduced(shaded->frame.info, *picture, 0); !taken) return taken.error();
  return shaded->start;
}

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

namespace {

/// Uploads a G-buffer with normals, as the first step of a drawing.
Result<Frame> begin_frame(Device& device, GBuffer gbuffer, const Recipe& recipe, StageTimes& times,
                          DrawProgress& progress) {
  auto frame = upload_with_normals(device, std::move(gbuffer), recipe.settings);
  if (!frame) return frame;
  progress.step_done();
  times.done("upload");
  return frame;
}

/// Runs a look on a frame, as the last step of a drawing.
Result<Drawn> run_on_frame(Device& device, Frame frame, LookRun run, StageTimes& times, DrawProgress& progress) {
  report_to(progress, times, run);
  const auto state = run_look(run, device, frame);
  if (!state) return state.error();
  if (auto ended = progress.end(); !ended) return ended.error();
  return Drawn{std::move(frame), state->stops};
}

}  // namespace

Result<Drawn> shade_planes(Device& device, GBuffer gbuffer, const Recipe& requested, StageTimes& times,
                           const ProgressMonitor& monitor, std::optional<float> stops) {
  gbuffer.info = info_of(gbuffer);
  const auto recipe = complete_shading(requested, gbuffer.info);
  if (!recipe) return recipe.error();
  DrawProgress progress(monitor, 1 + recipe->look->effects.size());
  auto frame = begin_frame(device, std::move(gbuffer), *recipe, times, progress);
  if (!frame) return frame.error();
  LookRun run = look_run(*recipe);
  run.stops = stops;
  return run_on_frame(device, std::move(*frame), run, times, progress);
}

Result<Frame> shade_technique(Device& device, GBuffer gbuffer, const Recipe& completed, StageTimes& times,
                              const ProgressMonitor& monitor) {
  Recipe recipe = completed;
  DrawProgress progress(monitor, 1 + recipe.look->effects.size());
  auto frame = begin_frame(device, std::move(gbuffer), recipe, times, progress);
  if (!frame) return frame;
  const std::vector<std::string> given = device.plane_names(*frame);
  auto drawn = run_on_frame(device, std::move(*frame), run_of_technique(recipe, given), times, progress);
  return drawn ? Result<Frame>(std::move(drawn->frame)) : drawn.error();
}

Result<Drawn> shade_after_technique(Device& device, const Frame& technique, const Recipe& completed, StageTimes& times,
                                    const ProgressMonitor& monitor, std::optional<float> stops) {
  DrawProgress progress(monitor, completed.look->effects.size());
  LookRun run = look_run(completed);
  run.has_technique = true;
  run.stops = stops;
  return run_on_frame(device, device.branch(technique), run, times, progress);
}

}  // namespace umbrage
