// umbrage-import: the import itself.
#pragma once
#include <filesystem>

#include "importer/common/serve_import.h"
#include "scene/readers/import.h"

namespace umbrage {

/// Does the work of import_scene in the current process: if a reader crashes, the process crashes. `process_ends`: the
/// process will end soon, so the reader's memory is not freed; the scene is returned before complete_import, which its
/// receiver must run, since it may use more memory and threads. Errors: those of import_scene.
Result<Scene> import_in_process(const std::filesystem::path& file, const ImportSettings& settings,
                                bool process_ends = false);

}  // namespace umbrage
