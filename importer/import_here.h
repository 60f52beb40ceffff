// Import in this process: a file becomes a Scene, by the readers of scene/ and by Assimp.
#pragma once
#include "scene/readers/import.h"

namespace umbrage {

/// What import_scene does, without a process between: a reader's crash is the program's. Where the process is about to
/// end, the reader's memory is left to the system, and points are left to complete_import. Errors: as of import_scene.
Result<Scene> import_here(const std::filesystem::path& file, const ImportSettings& settings, bool process_ends = false);

}  // namespace umbrage
