// The range of Material::specular_exponent.
#pragma once

namespace umbrage {

inline constexpr float kMinExponent = 1.0f;     ///< with less, a highlight is as wide as the diffuse lobe
inline constexpr float kMaxExponent = 2048.0f;  ///< with more, a highlight is smaller than a pixel

}  // namespace umbrage
