// Shadow lights: the lights with captured shadows, and the end points of rays to them.
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
  glm::vec3 where{0.0f};            ///< unit space: (point) position; (directional) direction to the light
  glm::vec3 right{0.0f}, up{0.0f};  ///< (directional) axes of its disc
  int rays = 0;                     ///< rays per pixel in the penumbra; 0: the light has no size
  float size = 0.0f;  ///< unit space: (point) radius of its sphere; (directional) tangent of half its disc's angle
};

/// Returns the size of a light: the radius of its sphere, or the tangent of half its disc's angle; 0: it has no size.
float light_size(const Light& light);

/// Returns whether a light casts shadows that the camera can see.
bool casts_visible_shadow(const Light& light);

/// Returns two unit directions perpendicular to `direction` and to each other.
std::pair<glm::vec3, glm::vec3> disc_axes(const glm::vec3& direction);

/// Size of a penumbra on a surface: squared radii along a row and along a column, in pixels squared.
struct PenumbraSize {
  float across = std::numeric_limits<float>::infinity(), down = std::numeric_limits<float>::infinity();
};

/// Reduces `size` to at most the penumbra of an occluder on a pixel's shadow ray. `depth` is the depth of the surface,
/// `direction` the direction of the camera ray, `toward` the vector from the surface to the light or the centre of its
/// disc, and `radius` the penumbra's radius perpendicular to `toward`, in unit space. [Fernando 2005]
void narrow(PenumbraSize& size, const CameraRays& rays, const Surface& surface, float depth, glm::vec3 direction,
            glm::vec3 toward, float radius);

/// Returns the shadow lights of a picture. The lights in `info` are in view space; shadow rays are in world axes.
std::vector<ShadowLight> shadow_lights(const TracedScene& traced, const CameraRays& rays, const PictureInfo& info,
                                       const CaptureSettings& settings);

inline constexpr int kDiscPoints = 256;  // number of rays to a light after which the end points repeat

/// Points on the unit disc for the rays of a packet, indexed by ray and pixel. Together they form a digital
/// (0, 2)-sequence [Sobol 1967], mapped to the disc [Shirley and Chiu 1997]: the 16 points of each ray are evenly
/// distributed, the points of several rays together more finely, and any four consecutive points of a pixel lie in four
/// different quadrants.
using DiscPoints = std::array<std::array<glm::vec2, kPacket>, kDiscPoints>;

DiscPoints disc_points();

/// Returns points on the border of the unit disc, one for each pixel of a packet.
std::array<glm::vec2, kPacket> disc_border_points();

}  // namespace umbrage
