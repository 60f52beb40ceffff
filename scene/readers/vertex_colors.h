// Conversion of vertex colours from files to linear light.
#pragma once
#include <algorithm>
#include <array>
#include <glm/vec3.hpp>

#include "core/color.h"

namespace umbrage {

/// Converts a display-referred sRGB colour, 0 to 1, to linear light; values outside are clamped, NaN becomes 0.
inline glm::vec3 linear_color(const glm::vec3& srgb) {
  // Most files store bytes: their 256 values come from a table.
  static const auto linear_from_byte = [] {
    std::array<float, 256> table{};
    for (int k = 0; k < 256; ++k) table[std::size_t(k)] = linear_from_srgb(float(k) / 255.0f);
    return table;
  }();
  glm::vec3 linear(0.0f);
  for (int c = 0; c < 3; ++c) {
    const float v = srgb[c] >= 0.0f ? std::min(srgb[c], 1.0f) : 0.0f;
    const int byte = int(v * 255.0f + 0.5f);
    linear[c] = float(byte) / 255.0f == v ? linear_from_byte[std::size_t(byte)] : linear_from_srgb(v);
  }
  return linear;
}

}  // namespace umbrage
