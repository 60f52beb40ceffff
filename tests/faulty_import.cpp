// An umbrage-import for tests, with a reader that fails as the file's name says: it crashes, never ends, waits forever,
// uses up memory, exits, or reports success without a result. Its time limits are lower than the real ones.
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <vector>

#include "importer/importer.h"
#include "scene/readers/import_in_child_process.h"
#include "scene/readers/texture_file.h"

namespace {

void fail(const std::filesystem::path& file) {
  const std::string fault = file.stem();
  std::signal(SIGSEGV, SIG_DFL);  // without a sanitizer's handler
  if (fault == "crash") std::raise(SIGSEGV);
  if (fault == "abort") std::abort();
  if (fault == "killed") std::raise(SIGKILL);
  if (fault == "exit") std::_Exit(7);
  if (fault == "throw") throw fault;
  if (fault == "spin") {
    const rlimit second{1, RLIM_INFINITY};
    ::setrlimit(RLIMIT_CPU, &second);
    while (true) ::getppid();
  }
  if (fault == "wait") {
    ::alarm(1);
    while (true) ::pause();
  }
  if (fault == "linger") {
    std::ofstream(file.string() + ".started");
    ::sleep(60);
  }
  if (fault == "hunger") {
    constexpr std::size_t kPieceBytes = std::size_t(1) << 26;
    for (std::vector<char*> pieces;;) pieces.push_back(new char[kPieceBytes]);
  }
  if (fault == "liar") {
    if (::write(umbrage::kImportResult, "nonsense", 8) == 8 && ::write(umbrage::kImportDone, "", 1) == 1) std::_Exit(0);
  }
}

umbrage::Result<umbrage::Scene> import(const std::filesystem::path& file, const umbrage::ImportSettings& settings) {
  fail(file);
  return umbrage::import_in_process(file, settings);
}

umbrage::Result<umbrage::Panorama> panorama(const std::filesystem::path& file) {
  fail(file);
  return umbrage::read_panorama(file);
}

}  // namespace

int main(int argc, char** argv) { umbrage::serve_import(argc, argv, import, panorama); }
