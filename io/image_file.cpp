// The table of image formats, the choice of a format, and atomic writing of files.
#include "io/image_file.h"

#include <fcntl.h>
#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <new>

#include "core/check.h"
#include "core/lists.h"
#include "core/lowercase.h"
#include "core/suggest.h"
#include "io/format.h"

namespace umbrage {
namespace fs = std::filesystem;
namespace {

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

bool allowed(const fs::path& path, int access) { return ::faccessat(AT_FDCWD, path.c_str(), access, AT_EACCESS) == 0; }

/// Returns the name of the temporary file beside `file`. The counter distinguishes threads, the process number
/// distinguishes programs. The name is truncated, so that it has at most 255 bytes with the suffix.
fs::path part_of(const fs::path& file) {
  static std::atomic<int> count = 0;
  constexpr std::size_t kMaxStemLength = 200;
  return folder_of(file) /
         fmt::format("{}.part-{}-{}", file.filename().string().substr(0, kMaxStemLength), ::getpid(), count++);
}

Error no_memory_to_write(const fs::path& file) {
  return device_error("not enough memory to write '{}'", file.string());
}

Error write_error(const fs::path& file, int cause) {
  if (cause == ENOMEM) return no_memory_to_write(file);
  return file_error("'{}' cannot be written: {}", file.string(), std::strerror(cause));
}

}  // namespace

Result<void> write_and_close(const fs::path& file, std::FILE* stream,
                             const std::function<Result<void>(std::FILE*)>& write) {
  if (!stream) return write_error(file, errno);
  errno = 0;
  Result<void> status;
  try {
    status = write(stream);
  } catch (const std::bad_alloc&) {
    status = no_memory_to_write(file);
  } catch (const InternalError& error) {
    status = Error{ErrorKind::kInternal, fmt::format("internal error: {}", error.what())};
  } catch (const std::exception& exception) {
    status = file_error("'{}' cannot be written: {}", file.string(), exception.what());
  }
  // For a short write errno names the cause better than a library's message.
  int cause = std::ferror(stream) ? errno : 0;
  if (std::fclose(stream) != 0 && cause == 0) cause = errno;
  if (cause != 0) return write_error(file, cause);
  return status;
}

std::span<const ImageFormat> image_formats() {
  static const ImageFormat table[] = {kPng, kExr, kPfm, kJpg, kJpeg, kWebp};
  return table;
}

std::string lowercase_extension(const fs::path& file) {
  const std::string own_extension = lowercase(file.extension().string());
  return own_extension.empty() ? own_extension : own_extension.substr(1);
}

Result<const ImageFormat*> format_of(const fs::path& file) {
  const std::string own_extension = lowercase_extension(file);
  std::vector<std::string> extensions, dotted;
  for (const ImageFormat& format : image_formats()) {
    if (format.extension == own_extension) return &format;
    extensions.emplace_back(format.extension);
    dotted.push_back("." + extensions.back());
  }
  if (own_extension.empty())
    return usage_error("'{}' does not end in an image extension; it must end in {}", file.string(),
                       joined_by_or(dotted));
  return usage_error("'{}' ends in '.{}', which is not a known image format; it must end in {}{}", file.string(),
                     own_extension, joined_by_or(dotted), did_you_mean(nearest_name(own_extension, extensions)));
}

Result<void> check_writable(const fs::path& file) {
  std::error_code ignored;
  if (file.empty()) return file_error("the name of the file to write is empty");
  if (!file.has_filename() || fs::is_directory(file, ignored))
    return file_error("'{}' is a folder: name a file in it", file.string());
  const fs::path folder = folder_of(file);
  if (!fs::is_directory(folder, ignored)) {
    const bool is_file = fs::exists(folder, ignored);
    return file_error("'{}' cannot be written: '{}' {}", file.string(), folder.string(),
                      is_file ? "is not a folder" : "does not exist; create that folder first");
  }
  const bool exists = fs::exists(file, ignored);
  if (exists && !allowed(file, W_OK))
    return file_error("'{}' cannot be written: the file exists and is write-protected", file.string());
  if ((!exists || fs::is_regular_file(file, ignored)) && !allowed(folder, W_OK | X_OK))
    return file_error("'{}' cannot be written: {} on folder '{}'", file.string(), std::strerror(errno),
                      folder.string());
  return {};
}

Result<void> check_sides(const fs::path& file, std::int64_t width, std::int64_t height) {
  if (width >= 1 && height >= 1 && width <= kMaxFileSide && height <= kMaxFileSide) return {};
  return file_error("'{}' has {} x {} pixels in its header: 1 to {} per side can be read", file.string(), width, height,
                    kMaxFileSide);
}

Result<void> check_size(const fs::path& file, std::int64_t width, std::int64_t height) {
  if (width >= 1 && height >= 1 && width <= kMaxFileSide && height <= kMaxFileSide && width * height <= kMaxFilePixels)
    return {};
  return file_error("'{}' has {} x {} pixels in its header: 1 to {} per side and at most {} in total can be read",
                    file.string(), width, height, kMaxFileSide, kMaxFilePixels);
}

Result<std::vector<const Plane*>> picture_planes(const fs::path& file, const Image& image, bool with_alpha) {
  if (image.width < 1 || image.height < 1)
    return file_error("'{}' cannot be written: the image is {} x {} pixels", file.string(), image.width, image.height);
  std::vector<const Plane*> planes = {image.find("color.r"), image.find("color.g"), image.find("color.b")};
  if (!contains(planes, nullptr)) {
    if (const Plane* alpha = image.find("color.a"); alpha && with_alpha) planes.push_back(alpha);
    return planes;
  }
  if (image.planes.size() == 1) return std::vector<const Plane*>{&image.planes[0]};
  std::string names;
  for (const std::string& name : image.names) names += (names.empty() ? "" : ", ") + name;
  return file_error(
      "'{}' cannot be written: a picture needs the planes color.r, color.g and color.b, or a single plane, and this "
      "image has {}; a .exr file takes any planes",
      file.string(), names.empty() ? "none" : names);
}

void bytes_of_row(std::span<const Plane* const> planes, int y, std::uint8_t* out) {
  constexpr float kMax = 255.0f;
  for (int x = 0; x < planes[0]->width; ++x)
    for (const Plane* plane : planes) {
      const float v = plane->at(x, y) > 0.0f ? plane->at(x, y) : 0.0f;
      *out++ = std::uint8_t((v < 1.0f ? v : 1.0f) * kMax + 0.5f);
    }
}

Image image_without_pixels(const ImageShape& shape) {
  Image image(shape.width, shape.height);
  image.names = shape.names;
  image.planes.resize(shape.names.size());
  return image;
}

ImageShape shape_of(const Image& image) { return {image.width, image.height, image.names}; }

MakeImageRows rows_of(const Image& image) {
  return [&image](const TakeImageRows& take) { return take(image); };
}

Image picture(int width, int height, int channels) {
  Image image(width, height);
  if (channels == 1) {
    image.add("grey");
    return image;
  }
  constexpr std::string_view kNames[] = {"color.r", "color.g", "color.b", "color.a"};
  for (int c = 0; c < channels; ++c) image.add(kNames[c]);
  return image;
}

namespace {

/// The temporary files being written, for a signal handler, which may only access lock-free atomics. If the list is
/// full, a temporary file is written normally but abandon_writes does not remove it.
constexpr int kMaxListedPaths = 64;
std::atomic<const char*> listed_paths[kMaxListedPaths];
static_assert(std::atomic<const char*>::is_always_lock_free);

/// Threads that are creating a temporary file at this moment, and whether abandon_writes forbids to create more.
std::atomic<int> creating = 0;
std::atomic<bool> writes_abandoned = false;

/// Creates the file `part` to write it. It fails if the file exists (errno is EEXIST) or after abandon_writes (EINTR).
/// Signals wait meanwhile: their handler calls abandon_writes, which waits for the end of this function.
std::FILE* create(const fs::path& part) {
  sigset_t all, before;
  sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  ++creating;
  errno = EINTR;
  // Not fopen: it takes locks of the C library, which the thread that the signal interrupted may hold.
  const int created =
      writes_abandoned ? -1 : ::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, DEFFILEMODE);
  const int cause = errno;
  --creating;
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  errno = cause;
  if (created < 0) return nullptr;
  std::FILE* stream = ::fdopen(created, "wb");
  if (stream) return stream;
  const int out_of_memory = errno;
  ::close(created);
  ::unlink(part.c_str());
  errno = out_of_memory;
  return nullptr;
}

/// An entry of the list for a path, during the lifetime of this object.
class ListedPath {
 public:
  explicit ListedPath(const fs::path& part) {
    for (auto& slot : listed_paths) {
      const char* free = nullptr;
      if (!slot.compare_exchange_strong(free, part.c_str())) continue;
      slot_ = &slot;
      return;
    }
  }
  ~ListedPath() {
    if (slot_) *slot_ = nullptr;
  }
  ListedPath(const ListedPath&) = delete;

 private:
  std::atomic<const char*>* slot_ = nullptr;
};

/// Returns the path of the file to write. If `file` is a symbolic link, this is its target: the link is kept.
fs::path target_of(const fs::path& file) {
  std::error_code code;
  fs::path resolved = fs::canonical(file, code);
  if (!code) return resolved;
  if (!fs::is_symlink(fs::symlink_status(file, code))) return file;
  const fs::path link_target = fs::read_symlink(file, code);  // target of a dangling link
  return link_target.is_absolute() ? link_target : file.parent_path() / link_target;
}

/// Renames the finished temporary file to the target; errors name `file`. A replaced file keeps its permissions.
Result<void> rename_to_target(const fs::path& part, const fs::path& target, const fs::path& file) {
  std::error_code code;
  if (const fs::file_status old = fs::status(target, code); fs::exists(old))
    fs::permissions(part, old.permissions(), code);
  fs::rename(part, target, code);
  return code ? write_error(file, code.value()) : Result<void>();
}

}  // namespace

void abandon_writes() {
  writes_abandoned = true;
  while (creating > 0) continue;
  for (const auto& slot : listed_paths)
    if (const char* part = slot) ::unlink(part);
}

Result<void> write_atomically(const fs::path& file, const std::function<Result<void>(std::FILE*)>& write) {
  if (Result<void> ok = check_writable(file); !ok) return ok;
  std::error_code code;
  const fs::path target = target_of(file);
  if (fs::exists(target, code) && !fs::is_regular_file(target, code)) {
    return write_and_close(file, std::fopen(target.c_str(), "wb"), write);
  }
  fs::path part;
  std::FILE* stream = nullptr;
  std::optional<ListedPath> listed;  // before the file is created, so that a signal handler always finds it
  constexpr int kAttempts = 16;      // an earlier process of the same number may have left such names
  for (int i = 0; i < kAttempts && !stream; ++i) {
    listed.reset();
    part = part_of(target);
    listed.emplace(part);
    stream = create(part);
    if (!stream && errno != EEXIST) break;
  }
  if (!stream) return write_error(file, errno);
  Result<void> status = write_and_close(file, stream, write);
  if (status) status = rename_to_target(part, target, file);
  if (!status) fs::remove(part, code);
  return status;
}

struct PartFile::State {
  fs::path file, target, part;
  ListedPath listed{part};
};

PartFile::PartFile(std::unique_ptr<State> state) : state_(std::move(state)) {}

PartFile::~PartFile() {
  std::error_code ignored;
  fs::remove(state_->part, ignored);
}

const fs::path& PartFile::path() const { return state_->part; }

Result<void> PartFile::keep() { return rename_to_target(state_->part, state_->target, state_->file); }

Result<std::unique_ptr<PartFile>> PartFile::begin(const fs::path& file) {
  if (Result<void> ok = check_writable(file); !ok) return ok.error();
  const fs::path target = target_of(file);
  std::error_code ignored;
  if (fs::exists(target, ignored) && !fs::is_regular_file(target, ignored))
    return file_error("'{}' cannot be written: it is a device or pipe, not a file", file.string());
  std::unique_ptr<State> state(new State{file, target, part_of(target)});
  return std::unique_ptr<PartFile>(new PartFile(std::move(state)));
}

Result<InputFile> open_to_read(const fs::path& file, std::int64_t& size) {
  std::error_code code;
  const fs::file_status status = fs::status(file, code);
  if (!fs::exists(status)) return file_error("'{}' does not exist", file.string());
  if (!fs::is_regular_file(status))
    return file_error("'{}' is {}, not an image file", file.string(),
                      fs::is_directory(status) ? "a folder" : "a device or pipe");
  InputFile stream(std::fopen(file.c_str(), "rb"));
  if (!stream) return file_error("'{}' cannot be opened: {}", file.string(), std::strerror(errno));
  size = std::int64_t(fs::file_size(file, code));
  if (code) return file_error("'{}' cannot be read: {}", file.string(), code.message());
  return stream;
}

Result<void> write_image(const fs::path& file, const Image& image, const WriteSettings& settings) {
  const Result<const ImageFormat*> format = format_of(file);
  return format ? (*format)->write(file, shape_of(image), settings, rows_of(image)) : format.error();
}

Result<void> write_image_rows(const fs::path& file, const ImageShape& shape, const WriteSettings& settings,
                              const MakeImageRows& make) {
  const Result<const ImageFormat*> format = format_of(file);
  return format ? (*format)->write(file, shape, settings, make) : format.error();
}

Result<Image> read_image(const fs::path& file) {
  try {
    std::int64_t size = 0;
    Result<InputFile> stream = open_to_read(file, size);
    if (!stream) return stream.error();
    char start[12] = {};
    const std::size_t byte_count = std::fread(start, 1, sizeof start, stream->get());
    stream->reset();
    std::vector<std::string> extensions;
    for (const ImageFormat& format : image_formats()) {
      const bool recognised = format.recognises(std::string_view(start, byte_count));
      if (recognised && !format.read)
        return file_error("'{}' is a .{} file, which is only written: convert it to .png", file.string(),
                          format.extension);
      if (recognised) return format.read(file);
      if (format.read) extensions.push_back("." + std::string(format.extension));
    }
    return file_error("'{}' {}: its content must be that of {}", file.string(),
                      size == 0 ? "is empty" : "is not an image that can be read", joined_by_or(extensions));
  } catch (const std::bad_alloc&) {
    return file_error("'{}' cannot be read: its pixels need more memory than is available", file.string());
  }
}

Result<void> write_text(const fs::path& file, std::string_view text) {
  return write_atomically(file, [&](std::FILE* stream) -> Result<void> {
    std::fwrite(text.data(), 1, text.size(), stream);
    return {};
  });
}

}  // namespace umbrage
