#include "renderer/times.h"

#include <algorithm>

namespace umbrage {

void StageTimes::done(std::string_view name) {
  const auto now = std::chrono::steady_clock::now();
  const double ms = std::chrono::duration<double, std::milli>(now - last).count();
  last = now;
  for (Stage& stage : stages)
    if (stage.name == name) {
      stage.ms += ms;
      return;
    }
  stages.push_back({std::string(name), ms});
}

double StageTimes::total() const {
  double sum = 0.0;
  for (const Stage& stage : stages) sum += stage.ms;
  return sum;
}

double TimeLimit::steady_clock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

TimeLimit::TimeLimit(double seconds, Clock clock)
    : seconds_(seconds), clock_(std::move(clock)), begin_(clock_()), last_(begin_) {}

bool TimeLimit::fits_another(int samples) {
  const double now = clock_(), duration = now - last_;
  last_ = now;
  if (samples_ > 0) durations_.insert(std::upper_bound(durations_.begin(), durations_.end(), duration), duration);
  samples_ = samples;
  expected_ = durations_.empty() ? duration / samples : durations_[durations_.size() / 2];
  return now - begin_ + expected_ <= seconds_;
}

bool TimeLimit::fits_part(double fraction) {
  const double now = clock_();
  if (part_ == 0.0) part_begin_ = now;
  const double of_sample = part_ > 0.0 ? (now - part_begin_) / part_ : expected_;
  if (now - begin_ + fraction * of_sample > seconds_) return false;
  part_ += fraction;
  return true;
}

}  // namespace umbrage
