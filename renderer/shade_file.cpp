#include "renderer/shade_file.h"

#include <algorithm>
#include <glm/vec2.hpp>

#include "effects/bitmask/bitmask.h"
#include "effects/output/output.h"
#include "effects/relight/relight.h"
#include "renderer/draw.h"
#include "renderer/reduced_rows.h"
#include "renderer/strip_drawer.h"
#include "renderer/strokes.h"

namespace umbrage {
namespace {

/// Returns the source of the strips of a file. Missing normals are reconstructed from depth.
StripSource file_source(Device& device, const GBufferFile& file, const Recipe& recipe, const PictureInfo& info,
                        StageTimes& times) {
  const auto read = [&](const Strip& strip, const ProgressMonitor& monitor) -> Result<Frame> {
    auto rows = file.rows(rows_with_margin(strip, info.height));
    if (!rows) return rows.error();
    times.done("read");
    GBuffer gbuffer{.info = info, .layers = {}};
    gbuffer.layers.push_back(std::move(*rows));
    auto frame = device.upload_strip(std::move(gbuffer), strip);
    const Effect& normals = *find_effect("normals");
    if (frame && !file.has_plane("normal.x"))
      if (auto status =
              device.run(normals, params_of(recipe.settings, normals.name), *frame, 0, PixelSet::kAll, monitor);
          !status)
        return status.error();
    times.done("upload");
    return frame;
  };
  return {.run = look_run(recipe),
          .height = info.height,
          .guard = 0,
          .lines = stroke_parameters_or_none(recipe),
          .make_frame = read,
          .after_look = [](Frame&, const ProgressMonitor&) { return Result<RunState>(RunState()); }};
}

}  // namespace

Result<StripSizes> plan_file_strips(const Device& device, const GBufferFile& file, const Recipe& recipe) {
  constexpr int kNormals = 3;  // reconstructed where they are missing
  const int planes = int(file.plane_names().size());
  Recipe of_file = recipe;
  of_file.capture.layers = 1;
  of_file.capture.back_sides = false;
  of_file.capture.extra_views = 0;
  const double pixels = double(file.info().width) * file.info().height;
  const double stored = file.is_in_memory() ? double(planes * sizeof(float)) * pixels : 0.0;
  return plan_strips(device, of_file, file.memory() - stored, planes + kNormals);
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
  StripSource source = file_source(device, file, *recipe, info, times);
  if (start) source.run.stops = start->stops;
  StripProgress progress(monitor, 1);
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

/// Returns whether the request sets this parameter.
bool is_set(const Recipe& recipe, std::string_view effect, std::string_view parameter) {
  return std::any_of(recipe.set_by_request.begin(), recipe.set_by_request.end(), [&](const Setting& setting) {
    return setting.effect->name == effect && setting.parameter->name == parameter;
  });
}

/// Treats an elevation model as maps do: it is solid, and lit from the north-west, which is the upper left, 45 degrees
/// high; unless the request sets these.
void shade_as_relief(Recipe& recipe) {
  constexpr glm::vec2 kNorthWestDeg(-35.2644f, 30.0f);  // towards (-1, 1, sqrt 2), as azimuth and elevation in the view
  recipe.from_above = true;
  if (!recipe.framing.light_deg) recipe.framing.light_deg = kNorthWestDeg;
  if (!is_set(recipe, "bitmask", "mode"))
    as<BitmaskParams>(params_of(recipe.settings, "bitmask")).mode = kBitmaskInfinite;
}

/// As for models, the median of what a camera inside a scene sees says little about the light there: a look that meters
/// it meters the picture instead, unless the request sets `metering`.
void meter_indoors(const PictureInfo& info, Recipe& recipe) {
  // A camera that frames a model is two of its radii from the nearest surface, or one if a ground reaches towards it.
  constexpr float kMinDistance = 0.5f;
  auto& output = as<OutputParams>(params_of(recipe.settings, "output"));
  const bool inside = !recipe.from_above && info.camera.projection == Projection::kPerspective &&
                      info.depth_min < kMinDistance * info.scene_radius;
  if (inside && output.metering == kMeteringMedian && !is_set(recipe, "output", "metering"))
    output.metering = kMeteringPicture;
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
  if (file.has_plane("ambient.r") && !is_set(*recipe, "relight", "source"))
    as<RelightParams>(params_of(recipe->settings, "relight")).source = kRelightPlanes;
  if (file.depth_meaning() == DepthMeaning::kHeight) shade_as_relief(*recipe);
  meter_indoors(file.info(), *recipe);
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

}  // namespace umbrage
