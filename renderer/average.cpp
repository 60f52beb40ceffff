// Averaged frames: what of them is averaged, and the lines that lie over the average.
#include <algorithm>

#include "effects/effects.h"
#include "effects/outline/outline.h"
#include "effects/output/output.h"
#include "renderer/drawing.h"

namespace umbrage {

void keep_lines(Drawing& drawing) {
  const auto& effects = drawing.recipe.look->effects;
  if (std::find(effects.begin(), effects.end(), "outline") == effects.end()) return;
  ParameterBytes& params = drawing.recipe.settings.find("outline")->second;
  auto& outline = as<OutlineParams>(params);
  if (outline.mode == kOutlinePaper || !(outline.opacity > 0.0f)) return;
  drawing.lines = params;
  outline.opacity = 0.0f;
}

std::vector<std::string> line_planes(const Drawing& drawing) {
  std::vector<std::string> names;
  if (drawing.lines.empty()) return names;
  const auto& read = find_effect("output")->passes[0].inputs;
  for (const Pass& pass : find_effect("outline")->passes)
    if (!pass.needed || pass.needed(drawing.lines))
      for (const std::string_view plane : pass.outputs)
        if (std::find(read.begin(), read.end(), plane) != read.end()) names.emplace_back(plane);
  return names;
}

std::vector<std::string> also_averaged(const DrawSettings& settings, const Drawing& drawing) {
  std::vector<std::string> names = settings.averaged;
  for (const std::string& plane : line_planes(drawing)) std::erase(names, plane);
  return names;
}

std::vector<std::string> averaged_planes(const DrawSettings& settings, const Drawing& drawing) {
  std::vector<std::string> names = {"color.r", "color.g", "color.b", "color.a"};
  const auto also = also_averaged(settings, drawing);
  names.insert(names.end(), also.begin(), also.end());
  return names;
}

Result<void> draw_lines(Device& device, const Drawing& drawing, Frame& frame, StageTimes& times) {
  if (drawing.lines.empty() || drawing.capture.sample > 0) return {};
  auto done = device.run(*find_effect("outline"), drawing.lines, frame);
  times.done("outline");
  return done;
}

Result<Image> finished_color(Device& device, const PictureSum& total, const Drawing& drawing, const Image& lines,
                             const PictureInfo& info) {
  ParameterBytes output = drawing.output;
  auto mean = device.upload(mean_picture(total, info));
  if (!mean) return mean.error();
  if (auto done = device.add(lines, *mean); !done) return done.error();
  as<OutputParams>(output).exposure = 0.0f;  // each frame had them
  as<OutputParams>(output).shoulder = 1.0f;
  as<OutputParams>(output).sky = 0;
  if (auto done = device.run(*find_effect("output"), output, *mean); !done) return done.error();
  return device.download(*mean, {"color.r", "color.g", "color.b", "color.a"});
}

namespace {

/// Planes as a frame with a guard band has them: as much around, of what is at the rim.
Image with_band(const Image& inner, int band) {
  Image whole(inner.width + 2 * band, inner.height + 2 * band);
  for (std::size_t k = 0; k < inner.names.size(); ++k) {
    Plane& plane = whole.add(inner.names[k]) = Plane(whole.width, whole.height);
    for (int y = 0; y < whole.height; ++y)
      for (int x = 0; x < whole.width; ++x)
        plane.at(x, y) =
            inner.planes[k].at(std::clamp(x - band, 0, inner.width - 1), std::clamp(y - band, 0, inner.height - 1));
  }
  return whole;
}

}  // namespace

Result<void> finish_average(Device& device, const PictureSum& total, const Drawing& drawing,
                            const std::vector<std::string>& averaged, Frame& frame) {
  Image lines;
  if (const auto planes = line_planes(drawing); !planes.empty()) {
    auto drawn = device.download(frame, planes);
    if (!drawn) return drawn.error();
    lines = std::move(*drawn);
  }
  const auto color = finished_color(device, total, drawing, lines, inner_info(frame.info));
  if (!color) return color.error();
  if (auto done = device.add(with_band(*color, frame.info.guard), frame); !done) return done;
  return device.add(with_band(mean_planes(total, averaged), frame.info.guard), frame);
}

}  // namespace umbrage
