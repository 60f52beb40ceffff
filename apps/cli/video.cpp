#include "apps/cli/video.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "apps/cli/signals.h"
#include "core/lists.h"
#include "io/format.h"
#include "system/child_process.h"

namespace umbrage::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "ffmpeg";
constexpr std::array<std::string_view, 3> kExtensions = {"mp4", "webm", "gif"};

bool is_on_path(const char* program) {
  const char* path = std::getenv("PATH");
  std::string_view folders = path ? path : "";
  while (!folders.empty()) {
    const std::string_view folder = folders.substr(0, folders.find(':'));
    folders.remove_prefix(std::min(folder.size() + 1, folders.size()));
    const fs::path candidate = fs::path(folder.empty() ? "." : folder) / program;
    std::error_code ignored;
    if (fs::is_regular_file(candidate, ignored) && ::access(candidate.c_str(), X_OK) == 0) return true;
  }
  return false;
}

/// Quantizes [0, 1] to 8 bits as PNG files do: rounds to the nearest of 256 values; NaN becomes 0.
std::uint8_t byte_of(float v) {
  constexpr float kMax = 255.0f;
  return v > 0.0f ? std::uint8_t(std::min(v, 1.0f) * kMax + 0.5f) : std::uint8_t(0);
}

/// Returns the arguments of ffmpeg.
std::vector<std::string> ffmpeg_arguments(const std::string& extension, const VideoSettings& settings,
                                          const fs::path& part) {
  std::vector<std::string> words = {"-hide_banner", "-nostdin", "-loglevel", "error", "-y"};
  const auto add = [&](std::initializer_list<std::string> more) { words.insert(words.end(), more); };
  add({"-f", "rawvideo", "-pixel_format", settings.alpha ? "rgba" : "rgb24", "-video_size",
       fmt::format("{}x{}", settings.width, settings.height), "-framerate", fmt::format("{:g}", settings.frame_rate),
       "-i", "pipe:0", "-an"});
  if (extension == "gif") {
    // One palette, computed from all frames.
    add({"-filter_complex", "split[a][b];[a]palettegen[p];[b][p]paletteuse", "-loop", "0"});
  } else {
    // sRGB has the primaries of Rec. 709. Without the tags, players assume another conversion matrix.
    add({"-vf", "scale=out_color_matrix=bt709:out_range=tv", "-pix_fmt", settings.alpha ? "yuva420p" : "yuv420p",
         "-color_primaries", "bt709", "-color_trc", "bt709", "-colorspace", "bt709", "-color_range", "tv"});
    if (extension == "webm")
      add({"-crf", "24", "-b:v", "0"});
    else
      add({"-crf", "18", "-movflags", "+faststart"});
  }
  add({"-f", extension, part.string()});
  return words;
}

/// Checks the size of the frames. Errors: kUsage.
Result<void> check_size(const fs::path& file, const VideoSettings& settings) {
  const std::string extension = lowercase_extension(file);
  if (extension == "gif" || (settings.width % 2 == 0 && settings.height % 2 == 0)) return {};
  return field_error("width", fmt::format("{},{}", settings.width, settings.height),
                     "`{}` cannot be {}: width and height of a .{} must be even", extension);
}

}  // namespace

bool is_video(const fs::path& file) { return contains(kExtensions, lowercase_extension(file)); }

Result<void> check_video(const fs::path& file, const VideoSettings& settings) {
  const std::string extension = lowercase_extension(file);
  if (auto status = check_size(file, settings); !status) return status;
  if (extension == "mp4" && settings.alpha)
    return field_error(
        "transparent", true,
        "`{}` cannot be used with a .mp4, which has no alpha channel; write a .webm, a .gif or pictures");
  if (!is_on_path(kProgram))
    return file_error(
        "'{}' cannot be written: it needs the program {}, which is not on PATH; numbered pictures, such "
        "as -o turn.png, do not need it",
        file.string(), kProgram);
  const auto writable = check_writable(file);
  return writable ? writable : with_field(writable.error(), "--output");
}

Result<std::unique_ptr<Video>> Video::begin(const fs::path& file, const VideoSettings& settings) {
  std::unique_ptr<Video> video(new Video);
  video->file_ = file;
  video->settings_ = settings;
  auto part = PartFile::begin(file);
  if (!part) return part.error();
  video->part_ = std::move(*part);
  if (settings.width > 0)
    if (auto started = video->start(); !started) return started.error();
  return video;
}

Result<void> Video::start() {
  int ends[2] = {-1, -1};
  error_output_ = ::memfd_create("umbrage-ffmpeg", MFD_CLOEXEC);
  if (error_output_ < 0 || ::pipe2(ends, O_CLOEXEC) != 0)
    return file_error("'{}' cannot be written: {}", file_.string(), std::strerror(errno));
  frames_ = ends[1];
  // ffmpeg gets its own process group: Ctrl-C at the terminal ends this program, which then ends ffmpeg.
  const ChildProgram program{.program = kProgram,
                             .words = ffmpeg_arguments(lowercase_extension(file_), settings_, part_->path()),
                             .files = {{STDIN_FILENO, ends[0]}, {STDOUT_FILENO}, {STDERR_FILENO, error_output_}},
                             .own_group = true};
  int failed = 0;
  {
    const BlockSignals blocked;
    failed = start_child(program, child_);
    if (failed != 0) child_ = 0;
    set_child(child_);
  }
  ::close(ends[0]);
  if (failed == 0) return {};
  return file_error("'{}' cannot be written: the program {} does not start ({})", file_.string(), kProgram,
                    std::strerror(failed));
}

Result<void> Video::wait() {
  if (frames_ >= 0) ::close(frames_);
  frames_ = -1;
  if (child_ == 0) return {};
  int status = 0;
  pid_t waited = 0;
  do waited = ::waitpid(child_, &status, 0);
  while (waited < 0 && errno == EINTR);
  {
    const BlockSignals blocked;
    set_child(0);
    child_ = 0;
  }
  if (waited > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
  // The first line of the error output names the cause; later lines report its consequences.
  std::array<char, 4096> message{};
  const ssize_t message_size = ::pread(error_output_, message.data(), message.size(), 0);
  std::string_view text(message.data(), std::size_t(std::max<ssize_t>(message_size, 0)));
  text = text.substr(0, text.find('\n'));
  if (text.starts_with('[') && text.find("] ") != std::string_view::npos) text.remove_prefix(text.find("] ") + 2);
  std::string reason;
  constexpr std::size_t kMaxLength = 200;
  for (const char c : text.substr(0, kMaxLength)) reason += std::iscntrl(static_cast<unsigned char>(c)) ? ' ' : c;
  if (reason.empty() && WIFSIGNALED(status)) reason = ::strsignal(WTERMSIG(status));
  return file_error("'{}' cannot be written: {} failed{}", file_.string(), kProgram,
                    reason.empty() ? "" : " (" + reason + ")");
}

Video::~Video() {
  if (child_ != 0) ::kill(child_, SIGKILL);
  static_cast<void>(bool(wait()));
  if (error_output_ >= 0) ::close(error_output_);
}

Result<void> Video::add(const Image& frame) {
  if (settings_.width == 0) {
    settings_.width = frame.width;
    settings_.height = frame.height;
    if (!check_size(file_, settings_))
      return field_error("--output", file_.string(), "{0} '{1}' cannot have {2} x {3} pixels: both must be even",
                         frame.width, frame.height);
    if (auto started = start(); !started) return started;
  }
  if (frame.width != settings_.width || frame.height != settings_.height)
    return file_error("'{}' cannot be written: a frame has {} x {} pixels, and those before it {} x {}", file_.string(),
                      frame.width, frame.height, settings_.width, settings_.height);
  const auto planes = picture_planes(file_, frame, settings_.alpha);
  if (!planes) return planes.error();
  const std::size_t channels = settings_.alpha ? 4 : 3;
  std::vector<std::uint8_t> row(std::size_t(frame.width) * channels);
  // Ignore SIGPIPE while writing: if ffmpeg has ended, the write must fail, but must not end this program.
  struct sigaction ignore {
  }, before{};
  ignore.sa_handler = SIG_IGN;
  ::sigaction(SIGPIPE, &ignore, &before);
  bool written = true;
  for (int y = 0; y < frame.height && written; ++y) {
    for (std::size_t c = 0; c < channels; ++c) {
      const Plane* plane = planes->size() == 1 && c < 3 ? (*planes)[0] : c < planes->size() ? (*planes)[c] : nullptr;
      for (int x = 0; x < frame.width; ++x)
        row[std::size_t(x) * channels + c] = plane ? byte_of(plane->at(x, y)) : std::uint8_t(255);
    }
    for (std::size_t at = 0; at < row.size() && written;) {
      const ssize_t count = ::write(frames_, row.data() + at, row.size() - at);
      if (count < 0 && errno == EINTR) continue;
      written = count > 0;
      if (written) at += std::size_t(count);
    }
  }
  ::sigaction(SIGPIPE, &before, nullptr);
  if (written) return {};
  if (auto ended = wait(); !ended) return ended;
  return file_error("'{}' cannot be written: {} stopped reading frames", file_.string(), kProgram);
}

Result<void> Video::finish() {
  if (auto ended = wait(); !ended) return ended;
  return part_->keep();
}

}  // namespace umbrage::cli
