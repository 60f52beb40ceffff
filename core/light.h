// Light: the light sources of a scene.
#pragma once
#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

namespace umbrage {

/// The roughness of a material that has no metalness and roughness.
inline constexpr float kNoRoughness = -1.0f;

enum class LightKind {
  kDirectional,  ///< parallel light; `direction` points from the surface to the light
  kPoint,        ///< falls off with the square of the distance; colour is the irradiance at distance `reach`
  kHead,         ///< at the camera, shining along the view axis, without falloff
};

/// One light, in world space or in view space as its owner states. Colours are linear Rec.709.
struct Light {
  LightKind kind = LightKind::kDirectional;
  glm::vec3 direction{0.0f, 1.0f, 0.0f};  ///< unit, towards the light (directional)
  glm::vec3 position{0.0f};               ///< (point)
  glm::vec3 color{1.0f};
  float reach = 0.0f;         ///< (point) distance at which the irradiance is `color`; 0: no falloff
  float angle_deg = 0.0f;     ///< (directional) angular diameter; 0: hard shadows
  float radius = 0.0f;        ///< (point) radius of the emitting sphere, scene units; 0: hard shadows
  bool casts_shadow = false;  ///< its shadow is captured if it is one of the first kMaxShadows lights

  bool operator==(const Light&) const = default;
};

/// The dependence of ambient light on the surface normal n: the radiance of a colour differs from its mean by (n, 1) M
/// (n, 1)^T [Ramamoorthi and Hanrahan 2001]. All 0: ambient light is uniform.
struct AmbientShape {
  std::array<glm::mat4, 3> by_color{glm::mat4(0.0f), glm::mat4(0.0f),
                                    glm::mat4(0.0f)};  ///< red, green, blue; symmetric

  /// Returns whether ambient light is uniform.
  bool even() const;
  /// Returns the difference from the mean for the normal `n`, a unit vector.
  glm::vec3 at(glm::vec3 n) const;
  bool operator==(const AmbientShape&) const = default;
};

/// Returns the shape, rotated.
AmbientShape turned(const AmbientShape& shape, const glm::mat3& rotation);

/// Factors per colour of the radiance that ambient light of a shape has by direction.
inline constexpr int kSkyFactors = 9;
/// Returns, for red, green and blue, the vector l and the traceless symmetric matrix Q (xx, yy, zz, xy, yz, zx) of the
/// radiance from the direction d, which differs from its mean by l.d + d'Qd. A shape holds 2/3 of l and 1/4 of Q
/// [Ramamoorthi and Hanrahan 2001].
std::array<float, 3 * kSkyFactors> sky_factors(const AmbientShape& shape);
/// Returns l.d times `first`, plus d'Qd times `second`, for red, green and blue.
glm::vec3 sky_radiance(const std::array<float, 3 * kSkyFactors>& factors, glm::vec3 d, float first = 1.0f,
                       float second = 1.0f);

/// Levels of a reflection map, for the roughness 0, 0.25, 0.5, 0.75 and 1; texels per side of each, without its border.
inline constexpr std::array<int, 5> kReflectionSides = {40, 24, 16, 10, 8};
inline constexpr int kReflectionLevels = int(kReflectionSides.size());

/// Returns the index of the first texel of a level; of the level after the last one: the number of texels.
constexpr int first_reflection_texel(int level) {
  int first = 0;
  for (std::size_t k = 0; k < std::size_t(level); ++k) first += (kReflectionSides[k] + 2) * (kReflectionSides[k] + 2);
  return first;
}
inline constexpr int kReflectionTexels = first_reflection_texel(kReflectionLevels);

/// The levels one after the other, row by row. A level is an octahedral map [Cigolle et al. 2014] of directions with a
/// border of one texel, which continues the map, so that bilinear lookups need no other case. A texel holds three
/// numbers of 9 bits, red lowest, and in the upper 5 bits the exponent e of their common factor 2^(e - 24).
using ReflectionMap = std::array<std::uint32_t, kReflectionTexels>;

/// Max lights whose shadows a capture can hold, one plane each.
inline constexpr int kMaxShadows = 8;

/// The lights of a scene, in world space.
struct Lighting {
  std::vector<Light> lights;  ///< the first one is the key light
  glm::vec3 ambient{0.3f};    ///< ambient radiance, mean over all normals
  AmbientShape ambient_shape;
  float lit_white_luminance = 1.0f;  ///< luminance of a white surface that faces the light; pictures are exposed for it
  /// What surfaces mirror, world space: all light but that of `lights`. Null: ambient light.
  std::shared_ptr<const ReflectionMap> reflections;

  bool operator==(const Lighting&) const = default;
};

}  // namespace umbrage
