// Linear light of 8-bit colours as integers, for averages of texels.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "core/color.h"

namespace umbrage {

/// 16-bit linear values of bytes, and the bytes nearest to 16-bit linear values.
struct ByteTransfer {
  std::array<std::uint32_t, 256> linear;
  std::vector<std::uint8_t> byte = std::vector<std::uint8_t>(1 << 16);

  /// `is_linear`: the bytes are linear values, else sRGB.
  explicit ByteTransfer(bool is_linear) {
    const auto value = [&](float v) { return 65535.0f * (is_linear ? v / 255.0f : linear_from_srgb(v / 255.0f)); };
    for (std::size_t v = 0, low = 0; v < 256; ++v) {
      linear[v] = std::uint32_t(value(float(v)) + 0.5f);
      const std::size_t end = v == 255 ? byte.size() : std::size_t(value(float(v) + 0.5f) + 0.5f);
      std::fill(byte.begin() + std::ptrdiff_t(low), byte.begin() + std::ptrdiff_t(end), std::uint8_t(v));
      low = end;
    }
  }
};

inline const ByteTransfer& byte_transfer(bool is_linear) {
  static const ByteTransfer srgb(false), plain(true);
  return is_linear ? plain : srgb;
}

}  // namespace umbrage
