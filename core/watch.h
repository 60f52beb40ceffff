// Watch: progress and cancellation of work on several threads.
#pragma once
#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include "core/progress.h"

namespace umbrage {

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
