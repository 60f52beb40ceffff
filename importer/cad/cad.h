// Import of STEP and IGES through OpenCASCADE.
#pragma once
#include <filesystem>

#include "core/result.h"
#include "scene/readers/import.h"

namespace umbrage {

/// Reads a STEP or IGES file: parts with their places in assemblies, names and colours, in millimetres, +z up, as
/// triangles that are made for ImportSettings::picture_px. The scene is returned before
/// complete_import. Errors: kFile.
Result<Scene> import_cad(const std::filesystem::path& file, const ImportSettings& settings);

}  // namespace umbrage
