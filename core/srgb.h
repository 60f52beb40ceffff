// The transfer function of sRGB [IEC 61966-2-1] on the host; effects/output has it as a kernel.
#pragma once
#include <cmath>

namespace umbrage {

/// Converts an sRGB value to linear light, both from 0 to 1.
inline float linear_from_srgb(float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); }

/// Converts linear light to an sRGB value, both from 0 to 1.
inline float srgb_from_linear(float v) {
  return v <= 0.0031308f ? v * 12.92f : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f;
}

}  // namespace umbrage
