#include "rays/camera_rays.h"

#include <glm/matrix.hpp>

namespace umbrage {

CameraRays camera_rays(const TracedScene& traced, const PictureInfo& info) {
  const Camera& camera = info.camera;
  CameraRays rays;
  rays.world_from_view = glm::transpose(glm::mat3(camera.view_from_world));
  rays.eye = traced.unit_of(camera.eye());
  const glm::mat3 axes = rays.world_from_view * traced.scale;
  const glm::vec3 right = axes[0] * ((camera.right - camera.left) / float(info.width));
  const glm::vec3 down = axes[1] * (-(camera.top - camera.bottom) / float(info.height));
  const glm::vec3 corner = axes[0] * camera.left + axes[1] * camera.top;
  const glm::vec3 forward = -axes[2];
  rays.origin = rays.eye;
  rays.direction = forward;
  if (camera.projection == Projection::kOrthographic) {
    rays.origin += corner;
    rays.origin_x = right;
    rays.origin_y = down;
  } else {
    rays.direction += corner;
    rays.direction_x = right;
    rays.direction_y = down;
  }
  return rays;
}

bool rays_within_limit(const CameraRays& rays, const PictureInfo& info) {
  for (const float x : {0.0f, float(info.width)})
    for (const float y : {0.0f, float(info.height)}) {
      if (!within_ray_limit(rays.origin_at(x, y)) || !within_ray_limit(rays.direction_at(x, y))) return false;
    }
  return true;
}

}  // namespace umbrage
