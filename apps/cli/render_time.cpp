#include "apps/cli/render_time.h"

#include <fmt/format.h>

#include <algorithm>

#include "renderer/recipe.h"

namespace umbrage::cli {

Result<void> choose_samples(RenderOptions& o) {
  constexpr int kMinFrames = 4;
  if (!(o.time_s > 0.0)) return {};
  if (o.request.anti_aliasing == 1)
    return with_field(field_error("anti_aliasing", 1,
                                  "`{}` {} draws one picture, and --time averages several: leave out one of them"),
                      "--time");
  const auto recipe = make_recipe(o.request, kMaxStripPixels);
  if (!recipe) return recipe.error();
  if (!o.request.anti_aliasing) o.request.anti_aliasing = std::max(recipe->frames, kMinFrames);
  return {};
}

TimedSamples::TimedSamples(double time_s, const ProgressMonitor& monitor) : monitor_(monitor) {
  if (time_s > 0.0) limit_.emplace(time_s);
}

Continuation TimedSamples::continuation() {
  if (!limit_) return {};
  return {.wants_another =
              [this](int samples) {
                is_last_ = !limit_->fits_another(samples);
                return !is_last_;
              },
          .wants_part =
              [this](double fraction) {
                is_last_ = !limit_->fits_part(fraction);
                return !is_last_;
              }};
}

ProgressMonitor TimedSamples::monitor() {
  if (!limit_ || !monitor_) return monitor_;
  return
      [this](double done) { return monitor_(is_last_ ? done : std::min(done, limit_->elapsed() / limit_->seconds())); };
}

std::string TimedSamples::summary(const Plan& plan) const {
  const std::string at_edges = plan.marked ? fmt::format(", and {} more at edges", plan.recipe.frames - 1) : "";
  const std::string part = limit_->part() > 0.0 ? fmt::format(" and {:.0f} % of one", 100.0 * limit_->part()) : "";
  return fmt::format("pictures averaged: {}{}{}, in {:.2f} s", limit_->samples(), part, at_edges, limit_->elapsed());
}

}  // namespace umbrage::cli
