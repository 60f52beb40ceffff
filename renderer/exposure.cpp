#include "renderer/exposure.h"

#include <algorithm>

#include "reference/reference.h"

namespace umbrage {
namespace {

/// Sets the size of a plan's picture so that its longer side has at most kMeteredSide pixels.
void make_small(Plan& plan) {
  int& width = plan.capture.width;
  int& height = plan.capture.height;
  const double scale = std::min(1.0, double(kMeteredSide) / std::max(width, height));
  width = std::max(int(width * scale), 1);
  height = std::max(int(height * scale), 1);
  plan.capture.guard = 0;
}

}  // namespace

bool meters_picture(const Plan& plan) {
  const Program program = program_of(plan);
  return std::any_of(program.operations.begin(), program.operations.end(), [](const Operation& operation) {
    return operation.kind == OperationKind::kMeter && operation.exposure == Exposure::kPicture;
  });
}

Result<std::optional<float>> metered_exposure(const Drawing& drawing, const Plan& plan) {
  if (drawing.run.stops || !meters_picture(plan)) return drawing.run.stops;
  const DrawProgress::Part part(drawing.progress, 0.0, 0.0);
  Plan small = plan.metered ? *plan.metered : plan;
  small.marked = false;
  const Camera camera = begin_picture(small, {.blended = small.has_blended});
  make_small(small);
  if (small.recipe.occlusion == reference_effect().name) {
    constexpr int kMaxSamples = 16;  // enough for a median
    int& samples = as<ReferenceParams>(params_of(small.recipe.settings, small.recipe.occlusion)).samples;
    samples = std::min(samples, kMaxSamples);
  }
  auto frame = drawing.device.capture(camera, small.capture, drawing.run.monitor);
  if (!frame) return frame.error();
  std::optional<float> stops;
  LookRun run = drawing.run;
  run.settings = &small.recipe.settings;
  run.kept.reset();
  run.after = [](std::string_view) {};
  run.meter = [&](Device& device, const Frame& metered) -> Result<std::optional<float>> {
    auto result = metered_stops(device, metered);
    if (result) stops = *result;
    return result ? Result<std::optional<float>>(std::nullopt) : result.error();  // ends the run
  };
  if (const auto state = run_look(run, drawing.device, *frame); !state) return state.error();
  drawing.times.done("metering");
  return stops;
}

}  // namespace umbrage
