#include "renderer/drawing.h"

#include <algorithm>

#include "reference/reference.h"
#include "renderer/devices.h"
#include "renderer/marked_samples.h"

namespace umbrage {

DrawProgress::Part::Part(DrawProgress& progress, double begin, double end)
    : progress_(progress), begin_(progress.begin_), size_(progress.size_), step_(progress.step_) {
  progress_.begin_ += size_ * begin;
  progress_.size_ = size_ * (end - begin);
  progress_.step_ = 0;
}

bool DrawProgress::report(double fraction) {
  // An effect of several dispatches or on several layers restarts at 0 for each.
  reported_ = std::max(reported_, std::min(begin_ + size_ * std::min((step_ + fraction) / steps_, 1.0), 1.0));
  return !monitor_ || monitor_(reported_);
}

void report_to(DrawProgress& progress, StageTimes& times, LookRun& run) {
  run.after = [&](std::string_view name) {
    times.done(name);
    progress.step_done();
  };
  run.monitor = progress.step_monitor();
}

std::size_t steps_of_picture(const Plan& plan) {
  return 1 + steps_of(look_run(plan.recipe)).size() + plan.lines.size();
}

Result<Frame> PictureDrawing::capture(const Plan& plan, const Camera& camera) const {
  auto frame =
      is_captured(plan) ? Result<Frame>(device.branch(*captured)) : device.capture(camera, plan.capture, run.monitor);
  if (!frame) return frame;
  frame->info.lines_between = plan.lines_between;
  if (plan.marked && plan.sample == 0) {
    const EffectStep step = marking_step(plan, frame->info);
    if (auto marked = device.run(*step.effect, step.params, *frame, {}, run.monitor); !marked) return marked.error();
  }
  if (!is_captured(plan)) times.done("capture");
  progress.step_done();
  if (!plan.recipe.hdri.shown()) return frame;
  const int height = frame->info.height;
  const Rows rows = plan.capture.strip ? rows_with_margin(*plan.capture.strip, height) : Rows{0, height};
  const auto added = device.add(sky_planes(plan.recipe.hdri, plan.up, plan.sky_gain, frame->info, rows), *frame);
  times.done("sky");
  return added ? frame : added.error();
}

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

Result<std::optional<float>> metered_exposure(const PictureDrawing& drawing, const Plan& plan) {
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
  LookRun run = drawing.run;
  // The device has the scene at another time of its animation. A CPU device meters the start, on any machine.
  std::unique_ptr<Device> at_start;
  if (small.start) {
    auto made = make_device("cpu", drawing.device.threads());
    if (!made) return made.error();
    at_start = std::move(*made);
    if (auto ready = at_start->prepare(*small.start, run.monitor); !ready) return ready.error();
    run.run_external_effect = reference_of(*at_start, *small.start, small, run.monitor);
  }
  Device& metering = at_start ? *at_start : drawing.device;
  auto frame = metering.capture(camera, small.capture, run.monitor);
  if (!frame) return frame.error();
  std::optional<float> stops;
  run.settings = &small.recipe.settings;
  run.kept.reset();
  run.after = [](std::string_view) {};
  run.meter = [&](Device& device, const Frame& metered) -> Result<std::optional<float>> {
    auto result = metered_stops(device, metered);
    if (result) stops = *result;
    return result ? Result<std::optional<float>>(std::nullopt) : result.error();  // ends the run
  };
  if (const auto state = run_look(run, metering, *frame); !state) return state.error();
  drawing.times.done("metering");
  return stops;
}

}  // namespace umbrage
