// Encoder: encodes pictures on its own thread, while the next one is drawn.
#pragma once
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "apps/view/encode.h"

namespace umbrage::view {

/// A picture to encode, and what is done with the result.
struct EncodeJob {
  Image picture;
  bool exact = false;
  /// Returns whether the picture is still wanted. Called before it is encoded.
  std::function<bool()> is_wanted;
  std::function<void(Result<Encoded> encoded, double ms)> done;
};

/// Encodes one picture after the other.
class Encoder {
 public:
  Encoder();
  ~Encoder();
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;
  /// Waits until the last picture is being encoded, so that no more than two are in memory.
  void add(EncodeJob job);

 private:
  void run();
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<EncodeJob> next_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace umbrage::view
