// Environment: an image of everything around a scene, and the light that it sends: the brightest places as lights with
// a size, the rest as ambient light by normal.
#pragma once
#include <glm/mat3x3.hpp>
#include <string>
#include <vector>

#include "core/light.h"

namespace umbrage {

/// An equirectangular image: row 0 is what is above, the last row what is below; from left to right it runs once
/// around, to the right of who looks at its middle.
struct Panorama {
  std::string name;  ///< file or description, for messages
  int width = 0, height = 0;
  std::vector<float> rgb;  ///< width * height * 3, radiance, linear Rec.709, finite and not below 0 once it is cleaned

  glm::vec3 at(int x, int y) const;
};

/// What Panorama::rgb may hold at most: more is a mistake, and its sums would leave what floats hold.
inline constexpr float kBrightestSky = 1e10f;

/// Makes every value finite: NaN and what is below 0 become 0, infinity the largest half float, 65504. Returns the
/// pixels that it changed.
std::size_t clean_panorama(Panorama& panorama);

/// The same light on fewer pixels: each is the mean of what it covers, by solid angle. Not larger than it was.
Panorama reduced_panorama(const Panorama& panorama, int most_width, int most_height);

/// Where a panorama lies in world space; its columns are what its middle, the place a quarter to the right of it and
/// its upper side point to. Its middle is +x, or +y where that is up, turned about `up`, to the left seen from inside,
/// by `rotation_deg`.
glm::mat3 panorama_axes(glm::vec3 up, float rotation_deg);

/// The direction, unit, in a panorama's own axes, of a point of it: x and y from 0 to 1, from its upper left corner.
glm::vec3 panorama_direction(float x, float y);

/// Radiance from a direction in its own axes, not 0, between its pixels' centres interpolated.
glm::vec3 panorama_radiance(const Panorama& panorama, glm::vec3 direction);

/// What shines out of a panorama. In its own axes.
struct EnvironmentLight {
  /// Parallel lights whose discs are as wide as what shines, the brightest first; each casts a shadow. Colours are the
  /// radiance of white that faces the light, as those of all lights.
  std::vector<Light> lights;
  glm::vec3 ambient{0.0f};  ///< the mean over all normals of the radiance of white; of an even white sky it is 1
  AmbientShape shape;       ///< its change with the normal
  /// Luminance of white that is turned to the most light, all lights arriving; 0 where all is black.
  float brightest = 0.0f;
};

inline constexpr int kMaxEnvironmentLights = 6;

/// Parts a panorama into lights and ambient light, so that nothing is lost: all spherical harmonics up to the second
/// degree, which are nearly all that a matt surface shows [Ramamoorthi and Hanrahan 2001], are those of the panorama.
/// What is brighter than four times the mean over all directions shines as lights; it is parted where that narrows its
/// parts most [Viriyothai and Debevec 2009]. The panorama must be clean.
EnvironmentLight environment_light(const Panorama& panorama);

/// A clear sky with a sun, above a grey ground, so that one may try without a file.
Panorama sky_panorama();

}  // namespace umbrage
