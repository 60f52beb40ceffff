// Encoding of pictures for the page: JPEG while something moves, PNG at rest. It runs on a thread of its own, while the
// next picture is drawn.
#pragma once
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "core/image.h"
#include "core/result.h"

namespace umbrage::view {

/// Quality of the JPEG of a moving picture, 1 to 100: artefacts are not seen in motion, and decoding is fast.
inline constexpr int kMovingQuality = 80;

/// A picture as the page gets it.
struct Encoded {
  std::string bytes;
  const char* format = "";  ///< "image/jpeg" or "image/png"
};

/// Encodes a picture: PNG if it is `exact` or has alpha, else JPEG. A PNG has the pixels that write_image writes.
Result<Encoded> encode(const Image& picture, bool exact);

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
