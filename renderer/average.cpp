// Averaged pictures: which planes are averaged, and the lines drawn over the average.
#include <algorithm>

#include "effects/effects.h"
#include "effects/output/output.h"
#include "renderer/average.h"

namespace umbrage {

std::vector<std::string> line_planes(const Plan& plan) {
  std::vector<std::string> names;
  if (plan.lines.empty()) return names;
  const auto& output_inputs = find_effect("output")->dispatches[0].inputs;
  for (const Dispatch& dispatch : find_effect("outline")->dispatches)
    if (!dispatch.needed || dispatch.needed(plan.lines))
      for (const std::string_view plane : dispatch.outputs)
        if (std::find(output_inputs.begin(), output_inputs.end(), plane) != output_inputs.end())
          names.emplace_back(plane);
  return names;
}

std::vector<std::string> other_averaged_planes(const Plan& plan) {
  std::vector<std::string> names = plan.recipe.averaged;
  for (const std::string& plane : line_planes(plan)) std::erase(names, plane);
  return names;
}

std::vector<std::string> averaged_planes(const Plan& plan) {
  std::vector<std::string> names;
  if (plan.recipe.wants("color.r")) names = {"color.r", "color.g", "color.b", "color.a"};
  const auto others = other_averaged_planes(plan);
  names.insert(names.end(), others.begin(), others.end());
  return names;
}

Result<RunState> draw_lines(Device& device, const Plan& plan, Frame& frame, const ProgressMonitor& monitor,
                            StageTimes& times) {
  if (plan.lines.empty() || plan.capture.sample > 0) return RunState();
  auto done = device.run(*find_effect("outline"), plan.lines, frame, 0, PixelSet::kAll, monitor);
  times.done("outline");
  return done;
}

Result<Image> finished_color(Device& device, const PictureSum& total, const Plan& plan, const Image& lines,
                             const PictureInfo& info) {
  ParameterBytes output = plan.output;
  auto mean = device.upload(mean_picture(total, info));
  if (!mean) return mean.error();
  if (auto done = device.add(lines, *mean); !done) return done.error();
  as<OutputParams>(output).exposure = 0.0f;  // already applied to each sample
  as<OutputParams>(output).tone = kToneNone;
  as<OutputParams>(output).shoulder = 1.0f;
  as<OutputParams>(output).sky = 0;
  if (auto done = device.run(*find_effect("output"), output, *mean); !done) return done.error();
  return device.download(*mean, {"color.r", "color.g", "color.b", "color.a"});
}

namespace {

/// Extends planes by a guard band of `guard` pixels, which repeats the border pixels.
Image with_guard_band(const Image& inner, int guard) {
  Image extended(inner.width + 2 * guard, inner.height + 2 * guard);
  for (std::size_t k = 0; k < inner.names.size(); ++k) {
    Plane& plane = extended.add(inner.names[k]) = Plane(extended.width, extended.height);
    for (int y = 0; y < extended.height; ++y)
      for (int x = 0; x < extended.width; ++x)
        plane.at(x, y) =
            inner.planes[k].at(std::clamp(x - guard, 0, inner.width - 1), std::clamp(y - guard, 0, inner.height - 1));
  }
  return extended;
}

}  // namespace

Result<void> finish_average(Device& device, const PictureSum& total, const Plan& plan, Frame& frame) {
  if (auto done = device.add(with_guard_band(mean_planes(total, other_averaged_planes(plan)), frame.info.guard), frame);
      !done)
    return done;
  if (!plan.recipe.wants("color.r")) return {};
  Image lines;
  if (const auto planes = line_planes(plan); !planes.empty()) {
    auto drawn = device.download(frame, planes);
    if (!drawn) return drawn.error();
    lines = std::move(*drawn);
  }
  const auto color = finished_color(device, total, plan, lines, inner_info(frame.info));
  if (!color) return color.error();
  return device.add(with_guard_band(*color, frame.info.guard), frame);
}

}  // namespace umbrage
