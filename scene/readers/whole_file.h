// Reading a file into memory.
#pragma once
#include <filesystem>
#include <string>

#include "core/progress.h"
#include "core/result.h"

namespace umbrage {

/// Returns all bytes of a file. Errors: kFile if it cannot be read; kInterrupted.
Result<std::string> read_whole_file(const std::filesystem::path& file, Poll* poll = nullptr);

}  // namespace umbrage
