// Lines of a picture as an SVG 1.1 file: paths without fill, with strokes as wide as the lines.
#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "core/result.h"
#include "core/strokes.h"

namespace umbrage {

/// Style of the file. Colours are sRGB: red, green and blue, 0 to 1.
struct SvgStyle {
  std::array<float, 3> color = {0.0f, 0.0f, 0.0f};  ///< colour of the lines
  float opacity = 1.0f;                             ///< opacity of all lines as a group: overlaps are not darker
  std::optional<std::array<float, 3>> background;   ///< colour of a rectangle behind the lines
};

/// Returns whether the file's extension is .svg, upper or lower case.
bool is_svg(const std::filesystem::path& file);

/// Returns the file's text: one group per kind of line and object, in that order, with class "outline", "fold" or
/// "crease" and the object id in data-object. A line of varying width becomes several paths. Errors: kUsage for
/// coordinates or widths that are not finite or above 1e9 in magnitude, and for negative widths.
Result<std::string> svg_text(const Strokes& strokes, const SvgStyle& style);

/// Writes svg_text to a file atomically. Errors: those of svg_text; kFile.
Result<void> write_svg(const std::filesystem::path& file, const Strokes& strokes, const SvgStyle& style);

}  // namespace umbrage
