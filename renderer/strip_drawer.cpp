#include "renderer/strip_drawer.h"

#include <algorithm>

#include "core/check.h"
#include "devices/shared/planes.h"
#include "renderer/strokes.h"

namespace umbrage {

void StripProgress::sweep_done() {
  ++sweep_;
  fraction_ = 0.0;
}

void StripProgress::sample_done(bool metered) {
  expected_sweeps_ = std::max(sweep_ - (metered ? 1 : 0), 1);
  ++sample_;
  sweep_ = 0;
}

bool StripProgress::report() {
  const double of_sample = std::min((sweep_ + fraction_) / expected_sweeps_, 1.0);
  reported_ = std::max(reported_, (sample_ + of_sample) / samples_);
  return !monitor_ || monitor_(reported_);
}

StripDrawer::StripDrawer(Device& device, StripSource source, int rows, StripProgress& progress, StageTimes& times)
    : device_(device), source_(std::move(source)), rows_(rows), progress_(progress), times_(times) {
  source_.run.after = [this](std::string_view name) { times_.done(name); };
  source_.run.monitor = progress.dispatch_monitor();
  source_.run.meter = [this](Device& of, const Frame& frame, Exposure by) { return meter(of, frame, by); };
}

Result<Strokes> StripDrawer::draw_picture(const std::vector<std::string>& planes, bool lines, const Finish& finish) {
  const auto whole_planes = std::make_shared<WholePlanes>();
  bool metered = false;
  sweep_ = 0;
  for (bool finished = false; !finished; ++sweep_) {
    metered_in_sweep_ = false;
    margins_.resize(std::max(margins_.size(), sweep_ + 1), margins_.empty() ? 0 : margins_.back());
    for (int begin = 0; begin < source_.height; begin += rows_) {
      const Rows strip{begin, std::min(begin + rows_, source_.height)};
      const auto strip_finished = draw_strip({strip, 0, whole_planes}, planes, finish);
      if (!strip_finished) return strip_finished.error();
      if (begin > 0 && finished != *strip_finished) fail_check("strips of one picture wait for different dispatches");
      finished = *strip_finished;
      progress_.show(double(strip.end) / source_.height);
    }
    for (auto& [key, entry] : whole_planes->planes) entry.complete = true;
    if (metered_in_sweep_) {
      source_.run.stops = metering_.stops(stops_from_lights_, metered_by_);
      metered = true;
    }
    progress_.sweep_done();
  }
  progress_.sample_done(metered);
  return lines ? lines_of(*whole_planes) : Strokes();
}

/// Traces the lines from the planes that the strips have gathered for the host step.
Strokes StripDrawer::lines_of(WholePlanes& whole_planes) const {
  Image planes(info_.width, info_.height);
  for (const std::string_view name : edge_planes(source_.lines, int(info_.more_layers.size()) + 1)) {
    planes.add(name) = Plane(info_.width, info_.height, neutral_value(name).value_or(0.0f));
    for (auto& [key, entry] : whole_planes.planes)
      if (std::get<0>(key) == info_.reduced && std::get<1>(key) == name) planes.plane(name) = std::move(entry.plane);
  }
  return traced_strokes(info_, planes, source_.lines, device_.threads());
}

/// Draws a strip, again with a larger margin until the margin suffices. Returns whether the strip is finished; if not,
/// its next dispatch reads planes that other strips must complete first.
Result<bool> StripDrawer::draw_strip(Strip strip, const std::vector<std::string>& planes, const Finish& finish) {
  const int height = source_.height, guard = source_.guard;
  int& margin = margins_[sweep_];
  for (;;) {
    prepare_plane_pool({std::max(strip.rows.begin - margin, 0), std::min(strip.rows.end + margin, height)});
    strip.margin = margin;
    first_ = std::clamp(strip.rows.begin, guard, height - guard) - guard;
    const auto state = try_strip(strip, planes, finish);
    if (!state) return state.error();
    if (state->finished || state->missing_rows == 0) return state->finished;
    if (margin > height)
      fail_check(fmt::format("a strip of a picture {} pixels high needs too large a margin", height));
    margin += state->missing_rows;
  }
}

/// Prepares the plane pool for strips with this number of rows: drops planes of other sizes, which cannot be reused.
void StripDrawer::prepare_plane_pool(const Rows& rows) {
  if (kept_ && kept_rows_ == rows.count()) return;
  kept_.reset();
  kept_.emplace(device_.pool());
  kept_rows_ = rows.count();
}

Result<RunState> StripDrawer::try_strip(const Strip& strip, const std::vector<std::string>& planes,
                                        const Finish& finish) {
  auto frame = source_.make_frame(strip, source_.run.monitor);
  if (!frame) return frame.error();
  info_ = frame->info;
  metered_missing_ = 0;
  const auto look_state = run_look(source_.run, device_, *frame);
  if (!look_state) return look_state.error();
  if (!look_state->finished) return RunState{false, std::max(look_state->missing_rows, metered_missing_)};
  stops_ = look_state->stops;
  const auto after = source_.after_look(*frame, source_.run.monitor);
  if (!after || !after->finished) return after;
  if (const int missing = device_.missing_rows(*frame, planes); missing > 0) return RunState{false, missing};
  auto rows = device_.download(*frame, planes);
  if (!rows) return rows.error();
  if (rows->height > 0)
    if (auto taken = finish(*frame, *rows, first_); !taken) return taken.error();
  return RunState();
}

/// Adds a strip to the metering. Returns no exposure: it is known only after a sweep over all strips, and the next
/// sweep uses it.
Result<std::optional<float>> StripDrawer::meter(Device& device, const Frame& frame, Exposure by) {
  metered_missing_ = device.missing_rows(frame, kMeteredPlanes);
  if (metered_missing_ > 0) return std::optional<float>();
  const auto rows = device.download(frame, kMeteredPlanes);
  if (!rows) return rows.error();
  metering_.add(*rows, first_, source_.height - 2 * source_.guard);
  stops_from_lights_ = stops_from_lights(frame.info);
  metered_by_ = by;
  metered_in_sweep_ = true;
  return std::optional<float>();
}

}  // namespace umbrage
