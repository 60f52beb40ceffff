// A check of OpenEXR headers before the OpenEXR library reads them.
#pragma once
#include <cstdint>
#include <cstdio>
#include <filesystem>

#include "core/result.h"

namespace umbrage {

/// Checks the headers of an EXR file, open as `stream`, of `size` bytes. The library allocates whatever a damaged
/// header claims: up to 2 GB for an attribute, and tables for windows of any size. Errors: kFile, naming `file`.
Result<void> check_exr_headers(const std::filesystem::path& file, std::FILE* stream, std::int64_t size);

}  // namespace umbrage
