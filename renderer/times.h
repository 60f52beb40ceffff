// StageTimes: milliseconds spent in each stage of drawing a picture.
#pragma once
#include <chrono>
#include <string>
#include <string_view>
#include <vector>

namespace umbrage {

/// Stages are in the order of their first completion. Stages of the same name are added up.
struct StageTimes {
  struct Stage {
    std::string name;
    double ms;
  };
  std::vector<Stage> stages;
  std::chrono::steady_clock::time_point last = std::chrono::steady_clock::now();

  /// Ends a stage that began when the previous one ended.
  void done(std::string_view name);
  double total() const;
};

}  // namespace umbrage
