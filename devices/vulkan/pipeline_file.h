// A file of compiled pipelines, so that a driver compiles each kernel once.
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace umbrage {

/// Returns the path umbrage/NAME in $XDG_CACHE_HOME or ~/.cache; empty if there is no such folder.
std::filesystem::path pipeline_file(const std::string& name);

/// Returns the data of write_pipelines; empty if there is none or the file is damaged.
std::vector<std::byte> read_pipelines(const std::filesystem::path& file);

/// Writes a temporary file, then renames it. Ignores errors: the next run compiles again.
void write_pipelines(const std::filesystem::path& file, const std::vector<std::byte>& data);

}  // namespace umbrage
