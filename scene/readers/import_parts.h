// What import in this process and import in another share.
#pragma once
#include <optional>

#include "scene/readers/import.h"

namespace umbrage {

/// The file's ending in lower case, without the dot.
std::string import_format(const std::filesystem::path& file);

/// What can be said against a file before it is parsed.
std::optional<Error> check_model_file(const std::filesystem::path& file, const std::string& format);

/// For a file that asks for more memory than it is given.
Error too_large_to_read(const std::filesystem::path& file);

/// What comes after a reader of any format: name, up, normals, clean triangles, bounds. Errors: kFile where nothing is
/// left to draw; kInterrupted.
Result<Scene> complete_import(Result<Scene> imported, const std::filesystem::path& file, const ImportSettings& settings,
                              Poll* poll = nullptr);

}  // namespace umbrage
