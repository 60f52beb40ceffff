// Colours as people write them: the names and hexadecimal notations of CSS.
#pragma once
#include <array>
#include <optional>
#include <span>
#include <string_view>

namespace umbrage {

/// Returns the sRGB colour, 0 to 1, of "#rrggbb", "#rgb" or a name of CSS Color Module Level 4, section 6.1, in upper
/// or lower case; nothing for other texts.
std::optional<std::array<float, 3>> named_color(std::string_view text);

/// Returns the names, sorted.
std::span<const std::string_view> color_names();

}  // namespace umbrage
