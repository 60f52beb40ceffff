// Watch: many threads work, one asks now and then whether to go on.
#pragma once
#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include "core/progress.h"

namespace umbrage {

/// One piece of work of so many parts, which any threads do. The thread that made the watch asks the monitor, as long
/// as it does parts itself, after its own ones and no more often than people see.
class Watch {
 public:
  /// The monitor lives longer than the watch.
  Watch(const ProgressMonitor& monitor, long parts) : monitor_(monitor), parts_(double(parts)) {
    if (monitor_ && !monitor_(0.0)) ended_ = true;
  }

  /// Whether the work has been ended: parts need not be done any more. From any thread.
  bool ended() const { return ended_.load(std::memory_order_relaxed); }

  /// So many parts have been done. From any thread.
  void done(long parts) {
    if (!monitor_) return;
    const long all = done_.fetch_add(parts, std::memory_order_relaxed) + parts;
    reached(double(all) / parts_);
  }

  /// This share of the work has been done, as who divides it says. From any thread.
  void reached(double share) {
    if (!monitor_ || std::this_thread::get_id() != asking_) return;
    const auto now = std::chrono::steady_clock::now();
    if (ended() || now - last_ < kAskEvery) return;
    last_ = now;
    told_ = std::max(told_, std::min(share, 1.0));
    if (!monitor_(told_)) ended_ = true;
  }

 private:
  const ProgressMonitor& monitor_;
  const double parts_;
  const std::thread::id asking_ = std::this_thread::get_id();
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  double told_ = 0.0;  // by that thread
  std::atomic<long> done_ = 0;
  std::atomic<bool> ended_ = false;
};

}  // namespace umbrage
