// The main function of umbrage-import. The readers are parameters.
#pragma once
#include <functional>

#include "scene/environment.h"
#include "scene/readers/import.h"

namespace umbrage {

using ImportFunction = std::function<Result<Scene>(const std::filesystem::path&, const ImportSettings&)>;
using PanoramaFunction = std::function<Result<Panorama>(const std::filesystem::path&)>;

/// Parses the command line that import_in_child_process or read_panorama_in_child_process built, reads the file within
/// the limits of importer/limits.h and sends the result. Does not return.
[[noreturn]] void serve_import(int argc, char** argv, const ImportFunction& import, const PanoramaFunction& panorama);

}  // namespace umbrage
