// Videos, encoded by the program ffmpeg, which reads the frames from a pipe.
#pragma once
#include <sys/types.h>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "core/image.h"
#include "core/result.h"

namespace umbrage {
class PartFile;  // io/format.h
}

namespace umbrage::cli {

/// Returns whether the extension of a file is that of a supported video format: .mp4, .webm, .gif.
bool is_video(const std::filesystem::path& file);

struct VideoSettings {
  int width = 0, height = 0;  ///< pixels; 0: of the first frame
  double frame_rate = 30.0;   ///< frames per second
  bool alpha = false;         ///< frames have alpha; not for .mp4
};

/// Checks that a video can be written, before any frame is drawn. Errors: kUsage for settings that the format does not
/// support; kFile if ffmpeg is not on PATH or the file cannot be written.
Result<void> check_video(const std::filesystem::path& file, const VideoSettings& settings);

/// A video that is being written. The file appears only when it is complete, in `finish`. For the main thread only.
class Video {
 public:
  /// Starts ffmpeg, or leaves that to the first frame, whose size is needed. Errors: kFile.
  static Result<std::unique_ptr<Video>> begin(const std::filesystem::path& file, const VideoSettings& settings);
  ~Video();
  Video(const Video&) = delete;
  /// Adds a frame: planes color.r, color.g, color.b and, with alpha, color.a; or one plane, as grey. Values are
  /// display values, 0 to 1. Errors: kFile, with the message of ffmpeg; kUsage for a first frame of an odd size.
  Result<void> add(const Image& frame);
  /// Waits for ffmpeg and gives the file its name. Errors: kFile.
  Result<void> finish();

 private:
  Video() = default;
  Result<void> start();
  /// Closes the pipe and waits for ffmpeg. Errors: kFile, with the first line of ffmpeg's error output.
  Result<void> wait();

  std::filesystem::path file_;
  VideoSettings settings_;
  std::unique_ptr<PartFile> part_;
  pid_t child_ = 0;
  int frames_ = -1, error_output_ = -1;  // file descriptors: the pipe that ffmpeg reads, and its error output
};

}  // namespace umbrage::cli
