// Reads /proc/meminfo (proc(5)) and the limit of the control group, version 2, that a container sees as its own.
#include "system/machine.h"

#include <malloc.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>
#include <system_error>

namespace umbrage {

double available_memory() {
  double available = std::numeric_limits<double>::infinity();
  std::ifstream info("/proc/meminfo");
  for (std::string line; std::getline(info, line);) {
    constexpr std::string_view kName = "MemAvailable:";
    constexpr double kUnit = 1024.0;  // "kB"
    if (line.starts_with(kName)) available = kUnit * std::strtod(line.c_str() + kName.size(), nullptr);
  }
  if (double limit = 0.0; std::ifstream("/sys/fs/cgroup/memory.max") >> limit) available = std::min(available, limit);
  return available;
}

void release_free_memory() {
#ifdef __GLIBC__
  ::malloc_trim(0);
#endif
}

Result<std::filesystem::path> temporary_folder() {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  if (!error) return folder;
  const char* named = std::getenv("TMPDIR");
  return file_error("the folder for temporary files, '{}', cannot be used: {}{}", named ? named : "/tmp",
                    error.message(), named ? "; set TMPDIR to another" : "");
}

Result<TemporaryFolder> TemporaryFolder::create() {
  const auto place = temporary_folder();
  if (!place) return place.error();
  std::string path = (*place / "umbrage-XXXXXX").string();
  if (!::mkdtemp(path.data()))  // mkdtemp lets only the owner in
    return file_error("a temporary folder cannot be created in '{}': {}", place->string(), std::strerror(errno));
  return TemporaryFolder(path);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
}

}  // namespace umbrage
