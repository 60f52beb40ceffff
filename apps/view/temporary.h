// What the viewer leaves behind if a signal ends the program: its temporary folder, and child processes that save.
#pragma once
#include <sys/types.h>

#include <filesystem>

#include "core/result.h"

namespace umbrage::view {

/// A private folder in the system's temporary folder, removed with its files by the destructor. It may hold files, and
/// folders of files.
class TemporaryFolder {
 public:
  /// Errors: kFile.
  static Result<TemporaryFolder> create();
  TemporaryFolder(TemporaryFolder&& other) noexcept : path_(std::move(other.path_)) { other.path_.clear(); }
  ~TemporaryFolder();

  const std::filesystem::path& path() const { return path_; }

 private:
  explicit TemporaryFolder(std::filesystem::path path) : path_(std::move(path)) {}
  std::filesystem::path path_;
};

/// A child process that abandon_view() ends, during the lifetime of this object.
class ListedChild {
 public:
  explicit ListedChild(pid_t child);
  ~ListedChild();
  ListedChild(const ListedChild&) = delete;

 private:
  int slot_ = -1;
};

/// Ends the listed child processes and removes the temporary folders. Async-signal-safe; signal handlers call it before
/// they end the program.
void abandon_view();

}  // namespace umbrage::view
