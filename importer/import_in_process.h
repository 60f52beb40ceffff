// Import in the current process: reads a file into a Scene with the readers of scene/ and with Assimp.
#pragma once
#include "scene/readers/import.h"

namespace umbrage {

/// Does the work of import_scene without a separate process: a crash of a reader is a crash of the caller. With
/// `process_ends` the reader's memory is not freed, and a scene with points is returned before complete_import, which
/// the caller runs. Errors: as import_scene.
Result<Scene> import_in_process(const std::filesystem::path& file, const ImportSettings& settings,
                                bool process_ends = false);

}  // namespace umbrage
