// A file's bytes.
#pragma once
#include <filesystem>
#include <string>

#include "core/progress.h"
#include "core/result.h"

namespace umbrage {

/// All of a file. Errors: kFile where it cannot be read; kInterrupted.
Result<std::string> read_whole_file(const std::filesystem::path& file, Poll* poll = nullptr);

}  // namespace umbrage
