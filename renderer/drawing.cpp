#include "renderer/drawing.h"

#include <algorithm>

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

Result<Frame> Drawing::capture(const Plan& plan, const Camera& camera) const {
  auto frame = captured ? Result<Frame>(device.branch(*captured)) : device.capture(camera, plan.capture, run.monitor);
  if (!frame) return frame;
  if (plan.marked && plan.capture.sample == 0) {
    const EffectStep step = marking_step(plan, frame->info);
    if (auto marked = device.run(*step.effect, step.params, *frame, {}, run.monitor); !marked) return marked.error();
  }
  if (!captured) times.done("capture");
  progress.step_done();
  if (!plan.recipe.hdri.shown()) return frame;
  const int height = frame->info.height;
  const Rows rows = plan.capture.strip ? rows_with_margin(*plan.capture.strip, height) : Rows{0, height};
  const auto added = device.add(sky_planes(plan.recipe.hdri, plan.up, plan.sky_gain, frame->info, rows), *frame);
  times.done("sky");
  return added ? frame : added.error();
}

}  // namespace umbrage
