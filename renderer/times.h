// StageTimes: milliseconds spent in each stage of a picture.
#pragma once
#include <chrono>
#include <string>
#include <string_view>
#include <vector>

namespace umbrage {

/// In the order of their first ends. Stages of one name add up.
struct StageTimes {
  struct Stage {
    std::string name;
    double ms;
  };
  std::vector<Stage> stages;
  std::chrono::steady_clock::time_point last = std::chrono::steady_clock::now();

  /// Ends a stage that began when the one before ended.
  void done(std::string_view name);
  double total() const;
};

}  // namespace umbrage
