// Lines of a picture as an SVG file, as Scalable Vector Graphics 1.1 has them: paths without fill, whose strokes are as
// wide as the lines.
#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "core/lines.h"
#include "core/result.h"

namespace umbrage {

/// Colours are sRGB, red, green and blue from 0 to 1.
struct SvgStyle {
  std::array<float, 3> color = {0.0f, 0.0f, 0.0f};  ///< of the lines
  float opacity = 1.0f;                             ///< of all lines together: where they overlap they are no darker
  std::optional<std::array<float, 3>> background;   ///< of a rectangle below them
};

/// Whether the file's ending is .svg, in letters of either case.
bool is_svg(const std::filesystem::path& file);

/// The file's text: one group for each kind of line and object, in that order, with class "outline", "fold" or "crease"
/// and the object's number in data-object. A line of changing width becomes several paths. Errors: kUsage for lines
/// with points that are no numbers, or a negative width.
Result<std::string> svg_text(const Lines& lines, const SvgStyle& style);

/// Writes it whole or not at all. Errors: kFile besides.
Result<void> write_svg(const std::filesystem::path& file, const Lines& lines, const SvgStyle& style);

}  // namespace umbrage
