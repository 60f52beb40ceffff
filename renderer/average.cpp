// Averaged pictures: which planes are averaged, and the lines drawn over the average.
#include <algorithm>

#include "core/lists.h"
#include "effects/effects.h"
#include "effects/output/output.h"
#include "renderer/average.h"

namespace umbrage {

namespace {

/// Returns the passes that hold the averaged picture: `color`, `beauty`, both or none.
std::vector<std::string> picture_passes(const Recipe& recipe) {
  std::vector<std::string> passes;
  if (recipe.wants("color.r") && !recipe.scene_linear) passes.emplace_back("color");
  const auto& output = params_of<OutputParams>(recipe.settings);
  if (recipe.wants("beauty.r") && output.beauty != kBeautyOff) passes.emplace_back("beauty");
  return passes;
}

}  // namespace

std::vector<std::string> line_planes(const Plan& plan) {
  std::vector<std::string> names;
  const auto& output_inputs = effect_with<OutputParams>().dispatches[0].inputs;
  for (const EffectStep& step : plan.lines)
    for (const Dispatch& dispatch : step.effect->dispatches)
      if (runs(dispatch, step.params))
        for (const std::string_view plane : dispatch.outputs)
          if (contains(output_inputs, plane) && !contains(names, plane)) names.emplace_back(plane);
  return names;
}

std::vector<std::string> other_averaged_planes(const Plan& plan) {
  std::vector<std::string> names = plan.recipe.averaged;
  for (const std::string& plane : line_planes(plan)) std::erase(names, plane);
  return names;
}

std::vector<std::string> averaged_picture(const Plan& plan) {
  std::vector<std::string> names;
  for (const std::string& pass : picture_passes(plan.recipe))
    for (const char* channel : {".r", ".g", ".b", ".a"}) names.push_back(pass + channel);
  return names;
}

std::vector<std::string> averaged_planes(const Plan& plan) {
  std::vector<std::string> names = averaged_picture(plan);
  const auto others = other_averaged_planes(plan);
  names.insert(names.end(), others.begin(), others.end());
  return names;
}

namespace {

constexpr std::size_t kChannels = 4;
constexpr const char* kBackgroundPart[] = {"beauty_background.r", "beauty_background.g", "beauty_background.b"};

void add_plane(const Plane& from, Plane& to) {
  for (int y = 0; y < to.height; ++y)
    for (int x = 0; x < to.width; ++x) to.row(y)[x] += from.row(y)[x];
}

/// Adds the finished planes of one of picture_passes to `finished`.
Result<void> finish_pass(Device& device, PictureSum& total, const Plan& plan, const std::string& pass,
                         const Image& lines, const PictureInfo& info, Image& finished) {
  ParameterBytes bytes = plan.output;
  auto& output = as<OutputParams>(bytes);
  output.exposure = 0.0f;  // already applied to each sample, like the next three
  output.tone = kToneNone;
  output.contrast = 1.0f;
  output.shoulder = 1.0f;
  output.sky = 0;
  output.blend = kBlendLight;
  if (pass == "color") output.beauty = kBeautyOff;
  std::vector<std::string> names = {pass + ".r", pass + ".g", pass + ".b", pass + ".a"};
  for (const char* plane : kBackgroundPart)
    if (pass == "beauty" && total.sum.find(plane)) names.emplace_back(plane);
  auto mean = device.upload(mean_picture(total, info, pass));
  if (!mean) return mean.error();
  if (auto status = device.add(lines, *mean); !status) return status;
  if (auto status = device.run(effect_with<OutputParams>(), bytes, *mean); !status) return status.error();
  auto planes = device.download(*mean, names);
  if (!planes) return planes.error();
  // The samples have some of the background, such as a sky.
  const Image of_samples = mean_planes(total, std::span(names).subspan(kChannels));
  for (std::size_t k = 0; k < names.size(); ++k) {
    Plane& plane = finished.add(names[k]) = std::move(planes->planes[k]);
    if (const Plane* more = of_samples.find(names[k])) add_plane(*more, plane);
  }
  return {};
}

}  // namespace

Result<Image> finished_picture(Device& device, PictureSum& total, const Plan& plan, const Image& lines,
                               const PictureInfo& info) {
  Image finished(total.sum.width, total.sum.height);
  for (const std::string& pass : picture_passes(plan.recipe))
    if (auto status = finish_pass(device, total, plan, pass, lines, info, finished); !status) return status.error();
  return finished;
}

namespace {

/// Extends planes by a guard band of `guard` pixels, which repeats the border pixels.
Image with_guard_band(Image inner, int guard) {
  if (guard == 0) return inner;
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

Result<void> finish_average(Device& device, PictureSum& total, const Plan& plan, const BlendedSample& blended,
                            Frame& frame) {
  if (auto status =
          device.add(with_guard_band(mean_planes(total, other_averaged_planes(plan)), frame.info.guard), frame);
      !status)
    return status;
  Image lines;
  if (const auto planes = line_planes(plan); !planes.empty()) {
    auto image = device.download(frame, planes);
    if (!image) return image.error();
    lines = std::move(*image);
    if (plan.has_blended) {
      blended.join_lines(lines, 0);
      if (auto status = device.add(with_guard_band(lines, frame.info.guard), frame); !status) return status;
    }
  }
  if (picture_passes(plan.recipe).empty()) return {};
  auto picture = finished_picture(device, total, plan, lines, inner_info(frame.info));
  if (!picture) return picture.error();
  return device.add(with_guard_band(std::move(*picture), frame.info.guard), frame);
}

}  // namespace umbrage
