// File descriptors, starting of child processes, and the programs that are installed with this one.
#pragma once
#include <sys/types.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace umbrage {

/// A file descriptor, which the destructor closes; -1: none.
class Descriptor {
 public:
  explicit Descriptor(int file = -1) : file_(file) {}
  Descriptor(Descriptor&& other) noexcept : file_(std::exchange(other.file_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(file_, other.file_);
    return *this;
  }
  ~Descriptor() { close(); }
  int file() const { return file_; }
  void close();

 private:
  int file_;
};

struct ChildProgram {
  struct File {
    int number;     ///< file descriptor in the child
    int from = -1;  ///< file descriptor of this process to duplicate; < 0: /dev/null, for reading and writing
  };

  std::string program;             ///< a path, or a name that is looked up on PATH
  std::vector<std::string> words;  ///< arguments, without the program name
  std::vector<File> files;         ///< open files of the child, besides those not marked close-on-exec
  bool own_group = false;          ///< put the child into its own process group, without signals of the terminal
};

/// Starts the program with all signals unblocked and at their defaults. Returns 0 and its process id in `child`, or an
/// errno value.
int start_child(const ChildProgram& program, pid_t& child);

/// Returns the path of a program that is installed with this one, such as umbrage-import: the first file found beside
/// the library or program that contains this function, in libexec/umbrage near it, in the installation path, or near
/// the program umbrage on PATH. Empty if there is none.
std::filesystem::path find_helper(const std::string& name);

}  // namespace umbrage
