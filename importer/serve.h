// The program umbrage-import, but for who reads.
#pragma once
#include <functional>

#include "scene/environment.h"
#include "scene/readers/import.h"

namespace umbrage {

using ImportFunction = std::function<Result<Scene>(const std::filesystem::path&, const ImportSettings&)>;
using PanoramaFunction = std::function<Result<Panorama>(const std::filesystem::path&)>;

/// Reads what import_apart or read_panorama_apart says on the command line, under the limits of importer/limits.h, and
/// hands it over. Does not return.
[[noreturn]] void serve_import(int argc, char** argv, const ImportFunction& import, const PanoramaFunction& panorama);

}  // namespace umbrage
