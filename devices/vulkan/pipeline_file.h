// Compiled pipelines on disk, so that a driver compiles each kernel once.
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace umbrage {

/// Where they are kept for a device, `NAME` of umbrage/NAME in $XDG_CACHE_HOME or ~/.cache; empty where there is no
/// such place.
std::filesystem::path pipeline_file(const std::string& name);

/// What write_pipelines wrote there, or nothing where there is none or it is not whole.
std::vector<std::byte> read_pipelines(const std::filesystem::path& file);

/// Written beside, then renamed. Where it cannot be written nothing happens: the next run compiles again.
void write_pipelines(const std::filesystem::path& file, const std::vector<std::byte>& data);

}  // namespace umbrage
