// Reads a file in blocks, with calls of the poll between them.
#include "scene/readers/whole_file.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <system_error>

namespace umbrage {

Result<std::string> read_whole_file(const std::filesystem::path& file, Poll* poll) {
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

}  // namespace umbrage
