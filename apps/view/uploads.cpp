#include "apps/view/uploads.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "apps/view/messages.h"

namespace umbrage::view {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMaxDropLength = 32, kMaxNameLength = 255;  // 255: the max of most file systems

bool is_drop(std::string_view drop) {
  return !drop.empty() && drop.size() <= kMaxDropLength &&
         drop.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789") == std::string_view::npos;
}

/// Returns a size as "1 GiB" or "5000 bytes".
std::string bytes_text(std::int64_t bytes) {
  constexpr std::int64_t kGib = std::int64_t(1) << 30;
  return bytes % kGib == 0 ? fmt::format("{} GiB", bytes / kGib) : fmt::format("{} bytes", bytes);
}

/// Copies `size` bytes to a new file. Returns 0, an errno value, or -1 if the input ended early.
int store(const fs::path& path, std::int64_t size, const Uploads::Read& read) {
  constexpr mode_t kOwnerOnly = 0600;
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, kOwnerOnly);
  if (file < 0) return errno;
  std::vector<char> buffer(std::size_t(1) << 16);
  int failed = 0;
  while (size > 0 && failed == 0) {
    const long count = read(buffer.data(), std::size_t(std::min<std::int64_t>(size, std::int64_t(buffer.size()))));
    if (count <= 0) failed = -1;
    for (long at = 0; at < count && failed == 0;) {
      const ssize_t written = ::write(file, buffer.data() + at, std::size_t(count - at));
      if (written > 0)
        at += written;
      else if (errno != EINTR)
        failed = errno;
    }
    size -= count;
  }
  if (::close(file) != 0 && failed == 0) failed = errno;
  if (failed != 0) ::unlink(path.c_str());
  return failed;
}

}  // namespace

Result<std::string> upload_name(std::string_view path) {
  const std::size_t slash = path.find_last_of("/\\");
  const std::string_view name = slash == std::string_view::npos ? path : path.substr(slash + 1);
  if (name.empty() || name == "." || name == "..") return usage_error("the name of an uploaded file is missing");
  if (has_control(name)) return usage_error("the name of an uploaded file has a control character");
  if (name.size() > kMaxNameLength)
    return usage_error("the name of an uploaded file has {} bytes; the max is {}", name.size(), kMaxNameLength);
  return std::string(name);
}

std::optional<Uploads::Refusal> Uploads::reserve(const std::string& drop, const std::string& file, std::int64_t size) {
  const std::lock_guard lock(mutex_);
  const auto of_drop = drops_.find(drop);
  const std::int64_t before = of_drop == drops_.end() ? 0 : of_drop->second;
  if (size > limits_.drop - before)
    return Refusal{Failure::kTooLarge, fmt::format("the files of a drop can have {}", bytes_text(limits_.drop))};
  if (size > limits_.total - total_ || int(files_.size()) >= limits_.files)
    return Refusal{Failure::kTooLarge, fmt::format("all uploaded files can have {} and be {}; start the viewer again",
                                                   bytes_text(limits_.total), limits_.files)};
  if (!files_.emplace(file, false).second)
    return Refusal{Failure::kExists, fmt::format("'{}' was already uploaded", file)};
  drops_[drop] = before + size;
  total_ += size;
  return {};
}

void Uploads::give_back(const std::string& drop, const std::string& file, std::int64_t size) {
  const std::lock_guard lock(mutex_);
  files_.erase(file);
  if ((drops_[drop] -= size) == 0) drops_.erase(drop);
  total_ -= size;
}

std::optional<Uploads::Refusal> Uploads::add(std::string_view drop, std::string_view path, std::int64_t size,
                                             const Read& read, std::string& file) {
  if (!is_drop(drop)) return Refusal{Failure::kInvalid, "the drop of an uploaded file must be 1 to 32 of a-z and 0-9"};
  const auto name = upload_name(path);
  if (!name) return Refusal{Failure::kInvalid, name.error().message};
  if (size < 0) return Refusal{Failure::kInvalid, "the size of an uploaded file is missing"};
  const std::string folder(drop);
  file = folder + "/" + *name;
  if (auto refusal = reserve(folder, file, size)) return refusal;
  constexpr mode_t kOwnerOnly = 0700;
  int failed = ::mkdir((folder_ / folder).c_str(), kOwnerOnly) == 0 || errno == EEXIST ? 0 : errno;
  if (failed == 0) failed = store(folder_ / file, size, read);
  if (failed != 0) {
    give_back(folder, file, size);
    return Refusal{Failure::kBroken, failed < 0
                                         ? fmt::format("'{}' arrived incomplete", file)
                                         : fmt::format("'{}' cannot be stored: {}", file, std::strerror(failed))};
  }
  const std::lock_guard lock(mutex_);
  files_[file] = true;
  return {};
}

Result<fs::path> Uploads::path_of(const std::string& file) const {
  const std::lock_guard lock(mutex_);
  if (const auto at = files_.find(file); at != files_.end() && at->second) return folder_ / file;
  return file_error("'{}' was not uploaded", file);
}

}  // namespace umbrage::view
