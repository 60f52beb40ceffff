#include "scene/readers/whole_file.h"

#include <cstdint>
#include <fstream>
#include <system_error>

namespace umbrage {

Result<std::string> read_whole_file(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  std::ifstream stream(file, std::ios::binary);
  std::string bytes(error ? 0 : std::size_t(size), '\0');
  if (!stream || error || !stream.read(bytes.data(), std::streamsize(bytes.size())))
    return file_error("{}: cannot be read", file.string());
  return bytes;
}

}  // namespace umbrage
