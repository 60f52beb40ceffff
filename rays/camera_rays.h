// Camera rays: the rays through the pixels of a picture, in unit space (rays/traced_scene.h).
#pragma once
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <limits>

#include "core/gbuffer.h"
#include "rays/traced_scene.h"

namespace umbrage {

inline constexpr float kRayInfinity = std::numeric_limits<float>::infinity();

/// The rays of a camera. The ray through the point (x, y) of the picture, in pixels from its top left corner, starts at
/// origin + x origin_x + y origin_y. Its direction is direction + x direction_x + y direction_y. The component of the
/// direction along the view axis equals TracedScene::scale, so that a ray's parameter is depth in scene units.
struct CameraRays {
  glm::mat3 world_from_view;
  glm::vec3 eye;
  glm::vec3 origin, origin_x{0.0f}, origin_y{0.0f};
  glm::vec3 direction, direction_x{0.0f}, direction_y{0.0f};

  glm::vec3 origin_at(float x, float y) const { return origin + origin_x * x + origin_y * y; }
  glm::vec3 direction_at(float x, float y) const { return direction + direction_x * x + direction_y * y; }
};

/// Returns the rays of a picture's camera.
CameraRays camera_rays(const TracedScene& traced, const PictureInfo& info);

/// Returns whether every ray of the picture is within kRayLimit. Embree ends the program for rays beyond the limit.
bool rays_within_limit(const CameraRays& rays, const PictureInfo& info);

}  // namespace umbrage
