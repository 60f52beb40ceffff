// Environment: a panorama of a scene's surroundings and the light that it emits. The brightest regions become
// directional lights with an angular size; the rest becomes ambient light that depends on the normal.
#pragma once
#include <glm/mat3x3.hpp>
#include <string>
#include <vector>

#include "core/light.h"

namespace umbrage {

/// An equirectangular image. Row 0 is the zenith, the last row the nadir. From left to right the columns run once
/// around; seen from inside, x increases to the right.
struct Panorama {
  std::string name;  ///< file or description, for messages
  int width = 0, height = 0;
  std::vector<float> rgb;  ///< width * height * 3, radiance, linear Rec.709; finite and at least 0 after clean_panorama

  glm::vec3 at(int x, int y) const;
};

/// Upper limit of Panorama::rgb. Larger values are errors of the file, and their sums would exceed the range of floats.
inline constexpr float kMaxRadiance = 1e10f;

/// Makes every value finite: NaN and negative values become 0, infinity becomes 65504 (the largest half float), other
/// values above kMaxRadiance become kMaxRadiance. Returns the number of changed pixels.
std::size_t clean_panorama(Panorama& panorama);

/// Downsamples a panorama to at most that size: each pixel is the mean of the pixels it covers, weighted by solid
/// angle. Never enlarges.
Panorama reduced_panorama(const Panorama& panorama, int max_width, int max_height);

/// Returns the orientation of a panorama in world space. The columns of the matrix are the world directions of the
/// panorama's centre, of the point a quarter turn to the right of it, and of its upper edge. The centre is +x (+y where
/// +x is up), rotated about `up` by `rotation_deg`, to the left as seen from inside.
glm::mat3 panorama_axes(glm::vec3 up, float rotation_deg);

/// Returns the unit direction, in the panorama's axes, of the point (x, y) of a panorama; x and y are 0 to 1, from the
/// upper left corner.
glm::vec3 panorama_direction(float x, float y);

/// Returns the radiance from `direction` (panorama axes, not zero), bilinear between pixel centres.
glm::vec3 panorama_radiance(const Panorama& panorama, glm::vec3 direction);

/// The light that a panorama emits, in the panorama's axes.
struct EnvironmentLight {
  /// Directional lights as wide as the bright regions, brightest first; each casts a shadow. `color` is, as for all
  /// lights, the radiance of a white surface that faces the light.
  std::vector<Light> lights;
  glm::vec3 ambient{0.0f};  ///< radiance of a white surface, averaged over all normals; 1 for a uniform white sky
  AmbientShape shape;       ///< change of ambient light with the normal
  /// Maximum luminance of a white surface over all normals, with all lights unoccluded; 0 for a black panorama.
  float brightest = 0.0f;
  /// The panorama without the light of `lights`, at most kMaxRestWidth pixels wide.
  Panorama rest;
};

inline constexpr int kMaxRestWidth = 256;

inline constexpr int kMaxEnvironmentLights = 6;

/// Splits a panorama into lights and ambient light without losing energy: their sum has the panorama's spherical
/// harmonics up to degree 2, which are nearly all that a diffuse surface shows [Ramamoorthi and Hanrahan 2001]. Pixels
/// brighter than four times the mean over all directions become lights; they are split where that reduces the variance
/// of direction most [Viriyothai and Debevec 2009]. The panorama must be clean (see clean_panorama).
EnvironmentLight environment_light(const Panorama& panorama);

/// Returns the built-in panorama: a clear sky with a sun above light ground, which sun and sky light and whose colour
/// fades into the sky's towards the horizon.
Panorama sky_panorama();

}  // namespace umbrage
