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

Average::Average(const Device& device, const Plan& plan, const Rows& rows, Plane marks)
    : sum_(empty_sum(averaged_planes(plan), plan.recipe.width, rows)) {
  sum_.as_square_roots = plan.recipe.look->averages_square_roots;
  sum_.threads = device.threads();
  sum_.marks = std::move(marks);
}

std::vector<std::string> Average::planes_of(const Plan& plan) {
  std::vector<std::string> names = averaged_planes(plan);
  if (!plan.capture.blended) return names;
  names = with_blend_planes(std::move(names));
  const auto lines = plan.sample == 0 ? line_planes(plan) : std::vector<std::string>();
  names.insert(names.end(), lines.begin(), lines.end());
  return names;
}

void Average::add(const Plan& plan, Image rows, int first) {
  if (rows.height == 0) return;  // a strip of the guard band
  const bool whole = !plan.marked || plan.sample == 0;
  if (plan.capture.blended)
    blended_.take_front(rows, line_planes(plan), first);
  else if (plan.has_blended)
    blended_.weigh_behind(rows, first);
  if (!plan.capture.blended && first == sum_.first) count_sample(sum_, whole);
  add_rows(sum_, rows, first, whole);
}

Result<void> Average::add(Device& device, const Plan& plan, const Frame& frame, int begin) {
  const std::vector<std::string> names = planes_of(plan);
  auto rows = plan.has_blended ? device.download(frame, names) : device.view(frame, names);
  if (!rows) return rows.error();
  add(plan, std::move(*rows), std::max(begin - frame.info.guard, 0));
  return {};
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

Result<Image> finished_average(Device& device, PictureSum total, const Plan& plan, const Image& lines,
                               const PictureInfo& info) {
  Image finished = mean_planes(total, other_averaged_planes(plan));
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

Result<void> finish_average(Device& device, Average average, const Plan& plan, Frame& frame) {
  auto lines = device.download(frame, line_planes(plan));
  if (!lines) return lines.error();
  average.join_lines(*lines, 0);
  auto finished = finished_average(device, average.take_sum(), plan, *lines, inner_info(frame.info));
  if (!finished) return finished.error();
  if (plan.has_blended)
    for (std::size_t k = 0; k < lines->names.size(); ++k) finished->add(lines->names[k]) = std::move(lines->planes[k]);
  return device.add(with_guard_band(std::move(*finished), frame.info.guard), frame);
}

}  // namespace umbrage
