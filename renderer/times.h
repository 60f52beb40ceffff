// Times: milliseconds spent in each stage of drawing a picture, and which further samples of a progressive drawing fit
// into a time: see Continuation in renderer/draw.h.
#pragma once
#include <chrono>
#include <functional>
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

/// Decides whether another sample fits into a time.
class TimeLimit {
 public:
  /// Returns seconds from any fixed moment.
  using Clock = std::function<double()>;
  static double steady_clock();

  /// The time begins now. `seconds` > 0.
  explicit TimeLimit(double seconds, Clock clock = steady_clock);

  /// As Continuation::wants_another. A sample is expected to take as long as the median of the further ones so far; the
  /// first of them, as long as the samples of the plan took on average, or together if all but one were marked samples.
  bool fits_another(int samples);

  /// As Continuation::wants_part, after fits_another. The first part is expected to take its fraction of the time of a
  /// sample, the others as long as those so far.
  bool fits_part(double fraction);

  double seconds() const { return seconds_; }
  double elapsed() const { return clock_() - begin_; }  ///< seconds
  int samples() const { return samples_; }              ///< of the last call of fits_another; 0: none
  double part() const { return part_; }                 ///< fraction of another sample that fitted, too

 private:
  double seconds_;
  Clock clock_;
  double begin_, last_;
  std::vector<double> durations_;  // of further samples, seconds, ascending
  int samples_ = 0;
  double expected_ = 0.0;               // time of another sample, seconds
  double part_ = 0.0, part_begin_ = 0;  // fraction of a sample that was found to fit, and when it began
};

}  // namespace umbrage
