#include "devices/vulkan/pipeline_file.h"

#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>

namespace umbrage {
namespace {

/// The beginning of the file, before the driver's data. It reveals damaged data, which not all drivers detect.
struct Header {
  char magic[8] = {'u', 'm', 'b', 'r', 'p', 'i', 'p', '1'};
  std::uint64_t size = 0, hash = 0;
};

/// Returns the FNV-1a hash.
std::uint64_t hash_of(const std::vector<std::byte>& data) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const std::byte byte : data) hash = (hash ^ std::uint64_t(byte)) * 0x100000001b3u;
  return hash;
}

}  // namespace

std::filesystem::path pipeline_file(const std::string& name) {
  const char* cache = std::getenv("XDG_CACHE_HOME");
  const char* home = std::getenv("HOME");
  std::filesystem::path folder;
  if (cache && cache[0] == '/')
    folder = cache;
  else if (home && home[0] == '/')
    folder = std::filesystem::path(home) / ".cache";
  else
    return {};
  return folder / "umbrage" / name;
}

std::vector<std::byte> read_pipelines(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  Header header;
  constexpr std::uint64_t kMax = std::uint64_t(1) << 30;
  if (!in.read(reinterpret_cast<char*>(&header), sizeof header) ||
      std::memcmp(header.magic, Header().magic, sizeof header.magic) != 0 || header.size > kMax)
    return {};
  std::vector<std::byte> data(header.size);
  if (!in.read(reinterpret_cast<char*>(data.data()), std::streamsize(data.size())) || hash_of(data) != header.hash)
    return {};
  return data;
}

void write_pipelines(const std::filesystem::path& file, const std::vector<std::byte>& data) {
  std::error_code failed;
  std::filesystem::create_directories(file.parent_path(), failed);
  const std::filesystem::path temporary = file.string() + "." + std::to_string(::getpid());
  Header header;
  header.size = data.size();
  header.hash = hash_of(data);
  bool written = false;
  {
    std::ofstream out(temporary, std::ios::binary);
    out.write(reinterpret_cast<const char*>(&header), sizeof header);
    out.write(reinterpret_cast<const char*>(data.data()), std::streamsize(data.size()));
    written = bool(out.flush());
  }
  if (written) std::filesystem::rename(temporary, file, failed);
  if (!written || failed) std::filesystem::remove(temporary, failed);
}

}  // namespace umbrage
