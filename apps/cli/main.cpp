// The program umbrage. For the commands that measure it starts umbrage-lab, as git starts its commands.
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "apps/cli/commands.h"
#include "apps/cli/lab_options.h"
#include "core/result.h"
#include "system/child_process.h"

namespace umbrage::cli {
namespace {

constexpr const char* kLab = "umbrage-lab";

/// Replaces this process by umbrage-lab with the same arguments. Returns only if that fails. Errors: kFile.
Error start_lab(char** argv) {
  const std::filesystem::path program = find_helper(kLab);
  if (!program.empty()) {
    ::execv(program.c_str(), argv);
    return file_error("the program '{}' does not start ({})", program.string(), std::strerror(errno));
  }
  ::execvp(kLab, argv);  // searches PATH
  return file_error("'{0}' needs the program {1}, which is missing: install the package {1}, or build the target {1}",
                    argv[1], kLab);
}

Error failure{ErrorKind::kFile, ""};  // of start_lab

template <class Options>
Result<void> fail(const Options& /*options*/) {
  return failure;
}

}  // namespace
}  // namespace umbrage::cli

int main(int argc, char** argv) {
  using namespace umbrage::cli;
  if (argc > 1 && std::find(kLabCommands.begin(), kLabCommands.end(), argv[1]) != kLabCommands.end())
    failure = start_lab(argv);
  // Without umbrage-lab, its commands still print their help.
  return run_program(argc, argv, {fail<CompareOptions>, fail<TuneOptions>, fail<FiguresOptions>, fail<BenchOptions>},
                     false);
}
