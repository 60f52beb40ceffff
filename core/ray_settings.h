// RaySettings: the rays that a dispatch traces in the captured scene.
#pragma once
#include <array>
#include <cstdint>

namespace umbrage {

/// Weight of an occluder at distance t.
enum class Falloff {
  kNone,    ///< 1 within the radius
  kLinear,  ///< 1 - t / radius
  kSmooth,  ///< 1 - smoothstep(0, radius, t)
};

/// Returns the weight of an occluder at distance `fraction` times the radius.
inline float falloff_weight(Falloff falloff, float fraction) {
  if (falloff == Falloff::kNone) return 1.0f;
  if (falloff == Falloff::kLinear) return 1.0f - fraction;
  return 1.0f - fraction * fraction * (3.0f - 2.0f * fraction);
}

struct RaySettings {
  int max_rays = 1;     ///< per pixel
  float radius = 1.0f;  ///< length of a ray, scene units
  Falloff falloff = Falloff::kNone;
  float light = 0.0f;           ///< factor for the light of the surfaces that rays hit; 0: it is not gathered
  float ambient_bounce = 1.0f;  ///< factor for the ambient light that these surfaces reflect
  std::uint32_t seed = 0;       ///< of the light that is chosen on a surface
  /// Factor for the difference that the direction of ambient light makes: a blocked ray adds the light of the whole
  /// hemisphere of the triangle's normal, minus that of its own direction. 0: off.
  float directional = 0.0f;
  std::array<float, 27> sky{};  ///< sky_factors() of ambient light, view space
};

}  // namespace umbrage
