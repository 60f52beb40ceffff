// Light: what shines on a scene.
#pragma once
#include <glm/vec3.hpp>

namespace umbrage {

enum class LightKind {
  kDirectional,  ///< parallel light; `direction` points from the surface to the light
  kPoint,        ///< falls off with the square of the distance; colour is the irradiance at distance `reach`
  kHead,         ///< at the eye, shining along the view axis, without falloff
};

/// One light, in world space or in view space as its holder says. Colours are linear Rec.709.
struct Light {
  LightKind kind = LightKind::kDirectional;
  glm::vec3 direction{0.0f, 1.0f, 0.0f};  ///< unit, towards the light (directional)
  glm::vec3 position{0.0f};               ///< (point)
  glm::vec3 color{1.0f};
  float reach = 0.0f;         ///< (point) distance at which `color` holds; 0 means no falloff
  float angle_deg = 0.0f;     ///< (directional) what its disc spans in the sky; 0: a point, with hard shadows
  float radius = 0.0f;        ///< (point) of the ball that shines, scene units; 0: a point, with hard shadows
  bool casts_shadow = false;  ///< its shadow is captured if it is one of the first kMostShadows lights
};

/// Lights whose shadows a capture can hold, one plane each.
inline constexpr int kMostShadows = 8;

}  // namespace umbrage
