// ProgressMonitor: reports the progress of long work to its caller, who may cancel it.
#pragma once
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <functional>

#include "core/result.h"

namespace umbrage {

/// Called repeatedly with the fraction of the work that is done, 0 to 1, only on the thread that requested the work.
/// Returns whether to continue: after false the work ends with `interrupted`. Null: no monitor.
using ProgressMonitor = std::function<bool(double done)>;

inline Error interrupted() { return {ErrorKind::kInterrupted, "interrupted"}; }

/// Min time between two calls of a monitor: what the viewer draws in vain is cancelled within it.
inline constexpr std::chrono::milliseconds kMonitorInterval(10);

/// Calls a monitor during work on one thread. Once the work is cancelled its result is discarded, so loops may stop at
/// once. The reported progress never decreases.
class Poll {
 public:
  /// `monitor` must outlive this object.
  explicit Poll(const ProgressMonitor& monitor) : monitor_(monitor) {}

  /// Starts a part of the work, which takes the progress from the fraction `from` to `to` of the whole.
  void part(double from, double to) {
    from_ = from;
    to_ = to;
    ask(0.0);
  }

  /// Calls the monitor now with this fraction of the part. Returns whether the work is cancelled.
  bool ask(double done) {
    if (!monitor_ || ended_) return ended_;
    last_ = std::chrono::steady_clock::now();
    reported_ = std::max(reported_, from_ + (to_ - from_) * std::min(done, 1.0));
    return ended_ = !monitor_(reported_);
  }

  /// Calls the monitor as above, but only if kMonitorInterval has passed since the last call.
  bool passing(double done) {
    if (!monitor_ || ended_ || std::chrono::steady_clock::now() - last_ < kMonitorInterval) return ended_;
    return ask(done);
  }

  bool ended() const { return ended_; }

 private:
  const ProgressMonitor& monitor_;
  double from_ = 0.0, to_ = 1.0, reported_ = 0.0;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  bool ended_ = false;
};

/// Returns whether a loop over `count` items should stop before `item`. Null: never.
inline bool stops(Poll* poll, std::size_t item, std::size_t count) {
  constexpr std::size_t kItems = 4096;  // items between two calls; they take far less than kMonitorInterval
  return poll && (poll->ended() || (item % kItems == 0 && poll->passing(double(item) / double(count))));
}

}  // namespace umbrage
