#include "rays/traced_lights.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

#include "rays/directions.h"

namespace umbrage {

std::vector<TracedLight> traced_lights(const TracedScene& traced, const CameraRays& rays, const PictureInfo& info,
                                       const TracedLightSettings& settings) {
  std::vector<TracedLight> lights;
  for (const Light& light : info.lights) {
    TracedLight out{.color = light.color};
    const bool head = light.kind == LightKind::kHead, points = settings.captured_shadows;
    if (points) out.casts_shadow = light.casts_shadow && !head && int(lights.size()) < kMaxShadows;
    out.point = light.kind == LightKind::kPoint || (head && info.camera.projection == Projection::kPerspective);
    if (head) {
      out.where = out.point ? rays.eye : rays.world_from_view[2];
      out.from_camera = !out.point;
    } else if (out.point) {
      out.where = rays.eye + rays.world_from_view * (light.position * traced.scale);
      out.reach_squared = light.reach * light.reach * traced.scale * traced.scale;
      out.min_squared = light.radius * light.radius * traced.scale * traced.scale;
      out.radius = points ? 0.0f : light.radius * traced.scale;
    } else {
      out.where = glm::normalize(rays.world_from_view * light.direction);
      const float light_deg = settings.sun_angle_deg > 0.0f ? settings.sun_angle_deg : light.angle_deg;
      const float angle_deg = points ? 0.0f : light_deg;
      const float sine = std::sin(glm::radians(0.25f * angle_deg));
      out.cone_height = 2.0f * sine * sine;
    }
    lights.push_back(out);
  }
  return lights;
}

namespace {

/// Returns the factor that makes a white surface that faces the cone's axis as bright as under a point light of the
/// same colour: 1 over the mean cosine of the cone's directions to its axis.
float cone_gain(float cone_height) { return 1.0f / (1.0f - 0.5f * cone_height); }

}  // namespace

LightSample sample_light(const TracedLight& light, const CameraRays& rays, glm::vec3 from, glm::vec2 sample) {
  if (!light.point) {
    const glm::vec3 direction = basis_around(light.where) * cone_direction(sample, light.cone_height);
    const float distance =
        light.from_camera ? glm::dot(rays.eye - from, light.where) : std::numeric_limits<float>::infinity();
    return {direction, distance, light.color * cone_gain(light.cone_height)};
  }
  const glm::vec3 to_center = light.where - from;
  const float squared = std::max(glm::dot(to_center, to_center), 1e-20f), distance = std::sqrt(squared);
  const glm::vec3 toward = to_center / distance;
  // The falloff is clamped at the sphere's surface: points inside a light would be fireflies.
  const float falloff_squared = std::max(squared, light.min_squared);
  const glm::vec3 color =
      light.reach_squared > 0.0f ? light.color * (light.reach_squared / falloff_squared) : light.color;
  if (!(light.radius > 0.0f)) return {toward, distance, color};
  // Seen from outside, the sphere fills a cone; from inside, a hemisphere is used.
  const float sine_squared = std::min(1.0f, light.radius * light.radius / squared);
  const float cone_height = sine_squared / (1.0f + std::sqrt(1.0f - sine_squared));
  const glm::vec3 local = cone_direction(sample, cone_height);
  const float to_sphere = distance * local.z -
                          std::sqrt(std::max(0.0f, light.radius * light.radius - squared * (1.0f - local.z * local.z)));
  return {basis_around(toward) * local, std::max(to_sphere, 0.0f), color * cone_gain(cone_height)};
}

}  // namespace umbrage
