// What the machine offers to programs: memory, and a folder for temporary files.
#pragma once
#include <filesystem>

#include "core/result.h"

namespace umbrage {

/// Returns how much memory, in bytes, programs may take without swapping: of the machine as the kernel estimates it,
/// and at most the limit of the container. Infinite if it is not known.
double available_memory();

/// Returns to the system what was freed but is kept for later. It takes milliseconds, and so does the next use of such
/// memory.
void release_free_memory();

/// Returns the folder for temporary files: TMPDIR, or /tmp. Errors: kFile if it is not a folder.
Result<std::filesystem::path> temporary_folder();

/// A folder in the system's temporary folder that only the user may enter; the destructor removes it with its content.
/// Signals that end the program must be handled so that destructors run: see wait_for_end in apps/cli/view.cpp.
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

}  // namespace umbrage
