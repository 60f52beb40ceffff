// Colours: the names and hexadecimal notations of CSS, and the transfer function of sRGB [IEC 61966-2-1] on the host;
// effects/output has it as a kernel.
#pragma once
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>

namespace umbrage {

/// Returns the sRGB colour, 0 to 1, of "#rrggbb", "#rgb" or a name of CSS Color Module Level 4, section 6.1, in upper
/// or lower case; nothing for other texts.
std::optional<std::array<float, 3>> named_color(std::string_view text);

/// Returns the names, sorted.
std::span<const std::string_view> color_names();

/// Converts an sRGB value to linear light, both from 0 to 1.
inline float linear_from_srgb(float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); }

/// Converts linear light to an sRGB value, both from 0 to 1.
inline float srgb_from_linear(float v) {
  return v <= 0.0031308f ? v * 12.92f : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f;
}

}  // namespace umbrage
