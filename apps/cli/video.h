// Videos, made by the program ffmpeg, to which frames are handed one after the other.
#pragma once
#include <sys/types.h>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include "core/image.h"
#include "core/result.h"

namespace umbrage {
class PartFile;  // io/format.h
}

namespace umbrage::cli {

/// Whether a file's ending names a video that can be made: .mp4, .webm, .gif.
bool is_video(const std::filesystem::path& file);

struct VideoSettings {
  int width = 0, height = 0;
  double frame_rate = 30.0;  ///< frames per second
  bool alpha = false;        ///< not for .mp4
};

/// Whether such a video can be made, before any frame is. Errors: kUsage for what the format cannot hold; kFile where
/// ffmpeg is not on PATH or the file cannot be written.
Result<void> check_video(const std::filesystem::path& file, const VideoSettings& settings);

/// A video in the making. It appears whole, with finish, or not at all. For the main thread.
class Video {
 public:
  static Result<std::unique_ptr<Video>> begin(const std::filesystem::path& file, const VideoSettings& settings);
  ~Video();
  Video(const Video&) = delete;
  /// Planes color.r, color.g, color.b and, with alpha, color.a; or one plane, as grey. As the file has them, 0 to 1.
  /// Errors: kFile, with what ffmpeg says.
  Result<void> add(const Image& frame);
  Result<void> finish();

 private:
  Video() = default;
  Result<void> start();
  /// Waits for ffmpeg, and gives what it said last where it failed.
  Result<void> wait();

  std::filesystem::path file_;
  VideoSettings settings_;
  std::unique_ptr<PartFile> part_;
  pid_t child_ = 0;
  int frames_ = -1, said_ = -1;  // open files: what ffmpeg reads, and writes its errors to
};

}  // namespace umbrage::cli
