// The main function of umbrage-import and umbrage-import-cad, which scene/readers/import_in_child_process.cpp starts,
// and their limits of processor time and address space, set with setrlimit and alarm.
#include "importer/common/serve_import.h"

#include <fcntl.h>
#include <malloc.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <new>
#include <string_view>
#include <system_error>

#include "scene/readers/import_in_child_process.h"
#include "scene/readers/import_parts.h"
#include "scene/readers/transfer.h"

namespace umbrage {

void serve_import(int argc, char** argv, const ImportFunction& import, const PanoramaFunction& panorama,
                  const ImportLimits& limits) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // ends this process when the host ends
  constexpr int kArguments = 13, kPanoramaArguments = 3;
  const bool is_panorama = panorama && argc == kPanoramaArguments && std::string_view(argv[1]) == kPanoramaOption;
  if ((argc != kArguments && !is_panorama) || ::fcntl(kImportResult, F_GETFD) < 0 ||
      ::fcntl(kImportDone, F_GETFD) < 0) {
    fmt::print(stderr, "{}: this program is started by umbrage and its library, not by hand\n",
               argc > 0 ? std::filesystem::path(argv[0]).filename().string() : "umbrage-import");
    std::_Exit(int(ErrorKind::kUsage));
  }
  // If the host has ended before the call to prctl, the pipe has no reader.
  if (pollfd pipe{.fd = kImportDone, .events = POLLOUT, .revents = 0}; ::poll(&pipe, 1, 0) > 0)
    if (pipe.revents & POLLERR) std::_Exit(int(ErrorKind::kInterrupted));
  const std::filesystem::path file = argv[is_panorama ? 2 : 1];
  // This process is short-lived and needs much memory: keep freed memory instead of returning it to the system.
  constexpr int kStep = 1 << 24, kNever = 1 << 30;
  ::mallopt(M_TOP_PAD, kStep);
  ::mallopt(M_TRIM_THRESHOLD, kNever);
  ::mallopt(M_MMAP_THRESHOLD, kNever);
  ::mallopt(M_ARENA_MAX, 1);  // each arena takes 64 MB of the address space
  limit_process(limits);
  raise_limits_for(file);
  const auto catch_bad_alloc = [&](const auto& read) -> decltype(read()) {
    try {
      return read();
    } catch (const std::bad_alloc&) {
      return too_large_to_read(file);
    }
  };
  bool sent = false;
  if (is_panorama) {
    sent = send_panorama(kImportResult, catch_bad_alloc([&] { return panorama(file); }));
  } else {
    const auto number = [&](int i) { return std::strtof(argv[i], nullptr); };
    const auto index = [&](int i) {
      const int value = std::atoi(argv[i]);
      return value == kNoIndex ? std::nullopt : std::optional(value);
    };
    ImportSettings settings{.up = {number(3), number(4), number(5)}, .scene_index = index(6)};
    if (const float angle = number(2); angle != kNoAngle) settings.crease_angle_deg = angle;
    settings.animation_index = index(7);
    settings.animation_time = number(8);
    settings.file_lights = number(9) != 0.0f;
    if (argv[10][0] == kFieldMark) settings.field = argv[10] + 1;
    settings.picture_px = std::atoi(argv[11]);
    settings.fitted_px = std::atoi(argv[12]);
    sent = send_import(kImportResult, catch_bad_alloc([&] { return import(file, settings); }));
  }
  const char byte = 1;
  if (sent && ::write(kImportDone, &byte, 1) == 1) std::_Exit(0);
  // _Exit, here and above: freeing memory object by object would only take time.
  std::_Exit(int(ErrorKind::kFile));
}

// ---- limits of processor time and address space

namespace {

constexpr double kWaitingPerSecond = 8.0;  ///< elapsed time per second of processor time, for a busy machine

ImportLimits limits_of_process;
double bytes_allowed = -1.0;  // below 0: limit_process has not been called

void set(int resource, double value) {
  rlimit limit{};
  if (::getrlimit(__rlimit_resource_t(resource), &limit) != 0) return;
  constexpr double kMax = 1e18;
  limit.rlim_cur = std::min(limit.rlim_max, rlim_t(std::min(value, kMax)));
  ::setrlimit(__rlimit_resource_t(resource), &limit);
}

void apply() {
  const ImportLimits& limits = limits_of_process;
  const double seconds = limits.base_seconds + limits.seconds_per_megabyte * 1e-6 * bytes_allowed;
  set(RLIMIT_CPU, seconds);
  if (memory_can_be_limited()) set(RLIMIT_AS, limits.base_memory + limits.memory_per_byte * bytes_allowed);
  ::alarm(unsigned(std::min(1e6, kWaitingPerSecond * seconds)));
}

}  // namespace

bool memory_can_be_limited() {
  double pages = 0.0;
  std::ifstream("/proc/self/statm") >> pages;
  constexpr double kMinShadowMemory = 1e12;  // bytes; the shadow memory of sanitizers is larger
  return pages * double(::sysconf(_SC_PAGESIZE)) < kMinShadowMemory;
}

void limit_process(const ImportLimits& limits) {
  limits_of_process = limits;
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
