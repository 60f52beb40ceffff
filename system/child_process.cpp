#include "system/child_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>
#include <csignal>

extern char** environ;

namespace umbrage {

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
