// Steps that import_in_child_process and import_in_process have in common.
#pragma once
#include <optional>

#include "scene/readers/import.h"

namespace umbrage {

/// Checks what can be checked before a file is parsed: existence, type, size, permission, and that `format`, which
/// format_of_file returns, is read.
std::optional<Error> check_model_file(const std::filesystem::path& file, const std::string& format);

/// Returns the error for a file that needs more memory than is available.
Error too_large_to_read(const std::filesystem::path& file);

/// Adds one warning for all properties of materials that are not drawn.
void warn_of_ignored(Scene& scene);

/// Completes a scene after a reader of any format: name, up, normals, removal of unusable triangles, bounds; texts of
/// the scene become printable. Errors: those of `imported`; kFile if nothing is left to draw; kInterrupted.
Result<Scene> complete_import(Result<Scene> imported, const std::filesystem::path& file, const ImportSettings& settings,
                              Poll* poll = nullptr);

}  // namespace umbrage
