// The main function of umbrage-import, which scene/readers/import_in_child_process.cpp starts.
#include "importer/serve.h"

#include <fcntl.h>
#include <malloc.h>
#include <poll.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <new>
#include <string_view>

#include "importer/limits.h"
#include "scene/readers/import_in_child_process.h"
#include "scene/readers/import_parts.h"
#include "scene/readers/transfer.h"

namespace umbrage {

void serve_import(int argc, char** argv, const ImportFunction& import, const PanoramaFunction& panorama) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // ends this process when the host ends
  constexpr int kArguments = 10, kPanoramaArguments = 3;
  const bool is_panorama = argc == kPanoramaArguments && std::string_view(argv[1]) == kPanoramaOption;
  if ((argc != kArguments && !is_panorama) || ::fcntl(kImportResult, F_GETFD) < 0 ||
      ::fcntl(kImportDone, F_GETFD) < 0) {
    fmt::print(stderr, "umbrage-import: this program is started by umbrage and its library, not by hand\n");
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
  limit_process();
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
    sent = send_import(kImportResult, catch_bad_alloc([&] { return import(file, settings); }));
  }
  const char byte = 1;
  if (sent && ::write(kImportDone, &byte, 1) == 1) std::_Exit(0);
  // _Exit, here and above: freeing memory object by object would only take time.
  std::_Exit(int(ErrorKind::kFile));
}

}  // namespace umbrage
