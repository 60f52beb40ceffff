// The counterpart of scene/readers/import_in_child_process.cpp, which starts this code in a separate process.
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
  constexpr int kWords = 7, kPanoramaWords = 3;
  const bool of_panorama = argc == kPanoramaWords && std::string_view(argv[1]) == kReadPanorama;
  if ((argc != kWords && !of_panorama) || ::fcntl(kImportResult, F_GETFD) < 0 || ::fcntl(kImportDone, F_GETFD) < 0) {
    fmt::print(stderr, "umbrage-import: this program is started by umbrage and its library, not by hand\n");
    std::_Exit(int(ErrorKind::kUsage));
  }
  // If the host has ended before the call to prctl, the pipe has no reader.
  if (pollfd pipe{.fd = kImportDone, .events = POLLOUT, .revents = 0}; ::poll(&pipe, 1, 0) > 0)
    if (pipe.revents & POLLERR) std::_Exit(int(ErrorKind::kInterrupted));
  const std::filesystem::path file = argv[of_panorama ? 2 : 1];
  // A short-lived process that needs much memory: freed memory is kept instead of returned to the system.
  constexpr int kStep = 1 << 24, kNever = 1 << 30;
  ::mallopt(M_TOP_PAD, kStep);
  ::mallopt(M_TRIM_THRESHOLD, kNever);
  ::mallopt(M_MMAP_THRESHOLD, kNever);
  limit_process();
  raise_limits_for(file);
  const auto guarded = [&](const auto& read) -> decltype(read()) {
    try {
      return read();
    } catch (const std::bad_alloc&) {
      return too_large_to_read(file);
    }
  };
  bool sent = false;
  if (of_panorama) {
    sent = send_panorama(kImportResult, guarded([&] { return panorama(file); }));
  } else {
    const auto number = [&](int i) { return std::strtof(argv[i], nullptr); };
    ImportSettings settings{.crease_angle_deg = number(2), .up = {number(3), number(4), number(5)}};
    if (const int scene = std::atoi(argv[6]); scene != kNoSceneIndex) settings.scene_index = scene;
    sent = send_import(kImportResult, guarded([&] { return import(file, settings); }));
  }
  const char byte = 1;
  if (sent && ::write(kImportDone, &byte, 1) == 1) std::_Exit(0);
  // Memory is not freed one by one, since the process ends.
  std::_Exit(int(ErrorKind::kFile));
}

}  // namespace umbrage
