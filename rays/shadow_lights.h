// Shadow lights: the lights whose shadows a capture holds, and where rays to them end.
#pragma once
#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <utility>
#include <vector>

#include "core/device.h"
#include "rays/camera_rays.h"
#include "rays/traced_scene.h"

namespace umbrage {

/// A light whose shadow is traced.
struct ShadowLight {
  int index = 0;
  bool point = false;
  glm::vec3 where{0.0f};            ///< in unit space: where it stands, or the direction to it
  glm::vec3 right{0.0f}, up{0.0f};  ///< (parallel) the axes of its disc
  int rays = 0;                     ///< of a pixel that it reaches in part; 0: it is a point
  float size = 0.0f;                ///< in unit space: radius of its ball; or half its disc's angle, as a tangent
};

/// The size of a light: of its ball's radius, or of half its disc's angle, as a tangent; 0: it is a point.
float light_size(const Light& light);

/// Whether it throws shadows that a camera sees.
bool casts_from_afar(const Light& light);

/// Two directions across a third.
std::pair<glm::vec3, glm::vec3> disc_axes(const glm::vec3& direction);

/// How wide a penumbra is on a surface: squares of its radius along a row and along a column, in pixels.
struct PenumbraSize {
  float across = std::numeric_limits<float>::infinity(), down = std::numeric_limits<float>::infinity();
};

/// Makes `size` the smaller of itself and the penumbra of what stops a ray from a pixel's surface towards a light.
/// `depth` is the surface's, `direction` that of the camera's ray, `toward` leads to the light or to its middle, and
/// the penumbra's radius across that is `radius`, in unit space. [Fernando 2005]
void narrow(PenumbraSize& size, const CameraRays& rays, const Surface& surface, float depth, glm::vec3 direction,
            glm::vec3 toward, float radius);

/// The lights are in view space; shadow rays run along world axes.
std::vector<ShadowLight> shadow_lights(const TracedScene& traced, const CameraRays& rays, const PictureInfo& info,
                                       const CaptureSettings& settings);

inline constexpr int kDiscPoints = 256;  // rays to a light after which their places repeat

/// Points of the unit disc for the rays of a packet's pixels, by ray and pixel. Together they are a digital
/// (0, 2)-sequence [Sobol 1967], mapped to the disc [Shirley and Chiu 1997]: each ray's sixteen points are spread
/// evenly, those of several rays more finely, and any four that a pixel has in a row lie in four quarters.
using DiscPoints = std::array<std::array<glm::vec2, kPacket>, kDiscPoints>;

DiscPoints disc_points();

/// Points around the rim of the disc, one for each pixel of a packet.
std::array<glm::vec2, kPacket> rim_points();

}  // namespace umbrage
