#include "system/child_process.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>
#include <csignal>

#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <system_error>

extern char** environ;

namespace umbrage {

namespace fs = std::filesystem;

namespace {

/// Adds the paths where a helper may be installed relative to a program or library.
void add_paths_near(const fs::path& module, const std::string& name, std::vector<fs::path>& paths) {
  if (!module.has_parent_path()) return;
  const fs::path folder = module.parent_path();
  paths.push_back(folder / name);
  paths.push_back(folder / "bin" / name);  // for a library in its build tree
  // For a module in PREFIX/bin, PREFIX/lib or PREFIX/lib/x86_64-linux-gnu.
  for (const char* up : {"..", "../.."}) paths.push_back(folder / up / "libexec" / "umbrage" / name);
}

/// Returns the program umbrage that a shell would start, with links resolved; an empty path if there is none.
fs::path program_on_path() {
  const char* list = std::getenv("PATH");
  for (std::string_view rest = list ? list : ""; !rest.empty();) {
    const fs::path folder = rest.substr(0, rest.find(':'));
    rest.remove_prefix(std::min(rest.find(':'), rest.size() - 1) + 1);
    const fs::path program = folder / "umbrage";
    std::error_code error;
    if (folder.is_absolute() && ::access(program.c_str(), X_OK) == 0 && fs::is_regular_file(program, error))
      return fs::canonical(program, error);
  }
  return {};
}

}  // namespace

void Descriptor::close() {
  if (file_ >= 0) ::close(file_);
  file_ = -1;
}

fs::path find_helper(const std::string& name) {
  std::vector<fs::path> paths;
  Dl_info module{};
  if (::dladdr(reinterpret_cast<const void*>(&find_helper), &module) != 0 && module.dli_fname)
    add_paths_near(module.dli_fname, name, paths);
  std::error_code error;
  if (const fs::path self = fs::read_symlink("/proc/self/exe", error); !error) add_paths_near(self, name, paths);
  paths.push_back(fs::path(UMBRAGE_LIBEXEC) / name);
  // A statically linked program does not know where the library was installed.
  add_paths_near(program_on_path(), name, paths);
  for (const fs::path& path : paths)
    if (::access(path.c_str(), X_OK) == 0) return path;
  return {};
}

int start_child(const ChildProgram& program, pid_t& child) {
  std::vector<char*> arguments = {const_cast<char*>(program.program.c_str())};
  for (const std::string& word : program.words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&files);
  posix_spawnattr_init(&attributes);
  for (const ChildProgram::File& file : program.files)
    if (file.from < 0)
      posix_spawn_file_actions_addopen(&files, file.number, "/dev/null", O_RDWR, 0);
    else
      posix_spawn_file_actions_adddup2(&files, file.from, file.number);
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  sigdelset(&all, SIGXFSZ);  // ignored by the child if this program ignores it
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setflags(&attributes, short(POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF |
                                              (program.own_group ? POSIX_SPAWN_SETPGROUP : 0)));
  const int failed = ::posix_spawnp(&child, program.program.c_str(), &files, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  return failed;
}

}  // namespace umbrage
