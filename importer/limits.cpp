// Limits of processor time and address space, set with setrlimit and alarm.
#include "importer/limits.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <system_error>

namespace umbrage {
namespace {

// OBJ, 3DS and glTF take 0.01 to 0.1 s per megabyte and at most 20 bytes of memory per byte (docs/reliability.md).
// The limits allow for slow machines and for highly compressed textures or buffers.
constexpr double kBaseSeconds = 8.0, kSecondsPerMegabyte = 2.0;
constexpr double kBaseMemory = 1.5e9, kMemoryPerByte = 200.0;
constexpr double kWaitingPerSecond = 8.0;  ///< elapsed time per second of processor time, for a busy machine

double bytes_allowed = -1.0;  // below 0: limit_process has not been called

void set(int resource, double value) {
  rlimit limit{};
  if (::getrlimit(__rlimit_resource_t(resource), &limit) != 0) return;
  constexpr double kMax = 1e18;
  limit.rlim_cur = std::min(limit.rlim_max, rlim_t(std::min(value, kMax)));
  ::setrlimit(__rlimit_resource_t(resource), &limit);
}

void apply() {
  const double seconds = kBaseSeconds + kSecondsPerMegabyte * 1e-6 * bytes_allowed;
  set(RLIMIT_CPU, seconds);
  if (memory_can_be_limited()) set(RLIMIT_AS, kBaseMemory + kMemoryPerByte * bytes_allowed);
  ::alarm(unsigned(std::min(1e6, kWaitingPerSecond * seconds)));
}

}  // namespace

bool memory_can_be_limited() {
  double pages = 0.0;
  std::ifstream("/proc/self/statm") >> pages;
  constexpr double kMinShadowMemory = 1e12;  // bytes; the shadow memory of sanitizers is larger
  return pages * double(::sysconf(_SC_PAGESIZE)) < kMinShadowMemory;
}

void limit_process() {
  bytes_allowed = 0.0;
  set(RLIMIT_CORE, 0.0);
  apply();
}

void raise_limits_for(const std::filesystem::path& file) {
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  if (!error) raise_limits_by(double(size));
}

void raise_limits_by(double bytes) {
  if (bytes_allowed < 0.0) return;
  bytes_allowed += bytes;
  apply();
}

}  // namespace umbrage
