// ProgressMonitor: reports the progress of long work to its caller, who may cancel it; Poll and Watch call it during
// work on one thread and on several.
#pragma once
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <thread>

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

/// Progress of work that consists of `parts` parts, which may run on any thread. Only the thread that created the watch
/// calls the monitor, when it finishes a part, at most once per kMonitorInterval.
class Watch {
 public:
  /// `monitor` must outlive the watch.
  Watch(const ProgressMonitor& monitor, long parts) : monitor_(monitor), parts_(double(parts)) {
    if (monitor_ && !monitor_(0.0)) ended_ = true;
  }

  /// Returns whether the work is cancelled: remaining parts may be skipped. Thread-safe.
  bool ended() const { return ended_.load(std::memory_order_relaxed); }

  /// Reports that `parts` more parts are done. Thread-safe.
  void done(long parts) {
    if (!monitor_) return;
    const long all = done_.fetch_add(parts, std::memory_order_relaxed) + parts;
    reached(double(all) / parts_);
  }

  /// Reports the fraction of the work that is done. Thread-safe.
  void reached(double fraction) {
    if (!monitor_ || std::this_thread::get_id() != monitor_thread_) return;
    const auto now = std::chrono::steady_clock::now();
    if (ended() || now - last_ < kMonitorInterval) return;
    last_ = now;
    reported_ = std::max(reported_, std::min(fraction, 1.0));
    if (!monitor_(reported_)) ended_ = true;
  }

 private:
  const ProgressMonitor& monitor_;
  const double parts_;
  const std::thread::id monitor_thread_ = std::this_thread::get_id();
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  double reported_ = 0.0;  // only accessed by monitor_thread_
  std::atomic<long> done_ = 0;
  std::atomic<bool> ended_ = false;
};

}  // namespace umbrage
