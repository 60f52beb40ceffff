// Other programs, started beside this one.
#pragma once
#include <sys/types.h>

#include <string>
#include <vector>

namespace umbrage {

struct ChildProgram {
  struct File {
    int number;     ///< in the program
    int from = -1;  ///< open file of this process that it is; below 0: the empty file, to read and to write
  };

  std::string program;             ///< a path, or a name to look for on PATH
  std::vector<std::string> words;  ///< what it is told, after its own name
  std::vector<File> files;         ///< those that it has; all that is marked close-on-exec is closed
  bool own_group = false;          ///< not what the terminal sends signals to
};

/// Starts it, with no signal blocked and none ignored. 0 and its number in `child`, or an error as of errno.
int start_child(const ChildProgram& program, pid_t& child);

}  // namespace umbrage
