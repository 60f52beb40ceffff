// StageTimes: milliseconds spent in each stage of drawing a picture.
#pragma once
#include <chrono>
#include <string>
#include <string_view>
#include <vector>

namespace umbrage {

/// The stages, in the order of their first completion. Times of the same stage are added up.
struct StageTimes {
  struct Stage {
    std::string name;
    double ms;
  };
  std::vector<Stage> stages;
  std::chrono::steady_clock::time_point last = std::chrono::steady_clock::now();

  /// Ends a stage that began when the previous stage ended.
  void done(std::string_view name);
  double total() const;
};

inline void StageTimes::done(std::string_view name) {
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

inline double StageTimes::total() const {
  double sum = 0.0;
  for (const Stage& stage : stages) sum += stage.ms;
  return sum;
}

}  // namespace umbrage
