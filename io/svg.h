// Drawings as SVG 1.1 files.
#pragma once
#include <string>

#include "core/drawing.h"
#include "core/result.h"

namespace umbrage {

/// Returns the file's text: a group per layer, with its name as class and its object id in data-object. The file's
/// unit is that of the drawing; its width and height are in millimetres where mm_per_unit is not that of a CSS pixel.
/// Errors: kUsage for numbers that are not finite or above 1e9 in magnitude; those of encode_png.
Result<std::string> svg_text(const Drawing& drawing);

}  // namespace umbrage
