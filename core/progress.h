// ProgressMonitor: who asked for long work hears how far it is, and may end it.
#pragma once
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <functional>

#include "core/result.h"

namespace umbrage {

/// Told now and then, by the thread that asked for the work and by no other, the share of it that is done, from 0 to 1.
/// Returns whether to go on: after false the work ends with `interrupted`. Null: nobody listens.
using ProgressMonitor = std::function<bool(double done)>;

inline Error interrupted() { return {ErrorKind::kInterrupted, "interrupted"}; }

/// How often a monitor is asked at most: no more often than people see.
inline constexpr std::chrono::milliseconds kAskEvery(40);

/// Asks a monitor from within work of one thread. After false the work is ended: what it makes is thrown away, so that
/// loops may stop where they are. What is told never falls.
class Poll {
 public:
  /// The monitor lives longer.
  explicit Poll(const ProgressMonitor& monitor) : monitor_(monitor) {}

  /// What follows is this share of the whole, and begins.
  void part(double from, double to) {
    from_ = from;
    to_ = to;
    ask(0.0);
  }

  /// Asks at once, with this share of the part done. Whether the work is ended.
  bool ask(double done) {
    if (!monitor_ || ended_) return ended_;
    last_ = std::chrono::steady_clock::now();
    told_ = std::max(told_, from_ + (to_ - from_) * std::min(done, 1.0));
    return ended_ = !monitor_(told_);
  }

  /// The same where it is time to ask.
  bool passing(double done) {
    if (!monitor_ || ended_ || std::chrono::steady_clock::now() - last_ < kAskEvery) return ended_;
    return ask(done);
  }

  bool ended() const { return ended_; }

 private:
  const ProgressMonitor& monitor_;
  double from_ = 0.0, to_ = 1.0, told_ = 0.0;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  bool ended_ = false;
};

/// In loops over `count` items, before each: whether to stop. Null: nobody asks.
inline bool stops(Poll* poll, std::size_t item, std::size_t count) {
  constexpr std::size_t kItems = 4096;  // take far less than kAskEvery
  return poll && (poll->ended() || (item % kItems == 0 && poll->passing(double(item) / double(count))));
}

}  // namespace umbrage
