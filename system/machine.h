// What the machine offers to programs: memory, and a folder for temporary files.
#pragma once
#include <filesystem>

#include "core/result.h"

namespace umbrage {

/// Returns how much memory, in bytes, programs may take without swapping: of the machine as the kernel estimates it,
/// and at most the limit of the container. Infinite if it is not known.
double available_memory();

/// Returns the folder for temporary files: TMPDIR, or /tmp. Errors: kFile if it is not a folder.
Result<std::filesystem::path> temporary_folder();

}  // namespace umbrage
