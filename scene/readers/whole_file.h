// A file's bytes.
#pragma once
#include <filesystem>
#include <string>

#include "core/result.h"

namespace umbrage {

/// All of a file. Errors: kFile where it cannot be read.
Result<std::string> read_whole_file(const std::filesystem::path& file);

}  // namespace umbrage
