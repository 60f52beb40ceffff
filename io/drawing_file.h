// Files of vector graphics.
#pragma once
#include <filesystem>
#include <string>

#include "core/drawing.h"
#include "core/result.h"

namespace umbrage {

/// Returns the extension of a file of vector graphics in lower case, "svg" or "dxf"; empty for other files.
std::string drawing_extension(const std::filesystem::path& file);
inline bool is_drawing(const std::filesystem::path& file) { return !drawing_extension(file).empty(); }

/// Writes a drawing in the format of the file's extension, atomically. Errors: those of svg_text or dxf_text; kFile;
/// kUsage for another extension.
Result<void> write_drawing(const std::filesystem::path& file, const Drawing& drawing);

}  // namespace umbrage
