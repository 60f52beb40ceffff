// Reads a file in blocks, with calls of the poll between them.
#include "scene/readers/whole_file.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <system_error>

#include "core/lowercase.h"
#include "scene/readers/gzip.h"

namespace umbrage {
namespace {

bool ends_in_gz(const std::filesystem::path& file) { return lowercase(file.extension().string()) == ".gz"; }

/// Returns the first bytes of a file as they are stored.
std::string stored_start(const std::filesystem::path& file, std::size_t count) {
  std::string bytes(count, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(bytes.data(), std::streamsize(bytes.size()));
  bytes.resize(std::size_t(std::max<std::streamsize>(0, stream.gcount())));
  return bytes;
}

/// Returns all bytes of a file as they are stored.
Result<std::string> stored_bytes(const std::filesystem::path& file, Poll* poll) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  std::ifstream stream(file, std::ios::binary);
  std::string bytes(error ? 0 : std::size_t(size), '\0');
  constexpr std::size_t kBlockSize = std::size_t(8) << 20;
  const Error unreadable = file_error("'{}' cannot be read", file.string());
  if (!stream || error) return unreadable;
  for (std::size_t at = 0; at < bytes.size(); at += kBlockSize) {
    if (poll && poll->passing(0.0)) return interrupted();
    if (!stream.read(bytes.data() + at, std::streamsize(std::min(kBlockSize, bytes.size() - at)))) return unreadable;
  }
  return bytes;
}

}  // namespace

Result<std::string> read_whole_file(const std::filesystem::path& file, Poll* poll) {
  auto bytes = stored_bytes(file, poll);
  if (!bytes) return bytes;
  if (is_gzip(*bytes)) {
    auto content = inflated(*bytes, file.string(), poll);
    if (content && content->empty()) return file_error("'{}' is empty", file.string());
    return content;
  }
  if (ends_in_gz(file)) return file_error("'{}' is not a gzip file", file.string());
  return bytes;
}

Result<std::size_t> inflated_size_of(const std::filesystem::path& file) {
  const auto bytes = stored_bytes(file, nullptr);
  if (!bytes) return bytes.error();
  return is_gzip(*bytes) ? inflated_size(*bytes, file.string()) : Result<std::size_t>(bytes->size());
}

std::string read_file_start(const std::filesystem::path& file, std::size_t count) {
  std::string bytes = stored_start(file, count);
  return is_gzip(bytes) ? inflated_start(bytes, count) : bytes;
}

bool is_gzip_file(const std::filesystem::path& file) {
  constexpr std::size_t kMagicSize = 3;
  return ends_in_gz(file) || is_gzip(stored_start(file, kMagicSize));
}

std::filesystem::path without_gz(const std::filesystem::path& file) {
  return ends_in_gz(file) ? std::filesystem::path(file).replace_extension() : file;
}

}  // namespace umbrage
