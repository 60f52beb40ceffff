#include "renderer/shade_strips.h"

#include "renderer/draw.h"
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

}  // namespace umbrage
