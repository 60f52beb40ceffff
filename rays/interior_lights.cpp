#include "rays/interior_lights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/trigonometric.hpp>

#include "rays/camera_rays.h"
#include "rays/ray_packet.h"

namespace umbrage {
namespace {

constexpr int kRayGrid = 32;                    // grid of rays, per side of the picture
constexpr float kMinDefaultCosine = 0.15f;      // min mean cosine of the default light on the visible surfaces
constexpr float kMinSunCosine = 0.02f;          // min mean cosine of the best sun; with less, sunlight cannot enter
constexpr float kDefaultDirectionBonus = 0.2f;  // relative bonus of a sun in the direction of the default light
// Brighter than the default light, since many visible surfaces are in shadow and there is only this light.
constexpr glm::vec3 kSun(1.5f, 1.38f, 1.18f), kLamp(1.1f, 1.0f, 0.85f);
// Oblique light shows shapes better: a sun at height kBestHeightDeg scores best. kLossPerDeg: relative loss of score
// per degree of deviation.
constexpr float kBestHeightDeg = 50.0f, kLossPerDeg = 0.01f;
constexpr float kSunDeg = 0.53f;      // angular diameter of the sun
constexpr float kLampHeight = 0.85f;  // fraction of the way from the camera to the ceiling
constexpr float kLampRadius = 0.05f;  // fraction of the median distance of the visible surfaces

/// A visible surface point.
struct VisiblePoint {
  Surface surface;
  glm::vec3 start;  // origin of rays that leave the surface, unit space
  float distance;   // from the camera, scene units
};

std::vector<VisiblePoint> visible_surfaces(const TracedScene& traced, const PictureInfo& info) {
  const CameraRays rays = camera_rays(traced, info);
  std::vector<VisiblePoint> points;
  if (!rays_within_limit(rays, info)) return points;
  for (int j = 0; j < kRayGrid; ++j)
    for (int i = 0; i < kRayGrid; ++i) {
      const float x = (float(i) + 0.5f) / kRayGrid * float(info.width),
                  y = (float(j) + 0.5f) / kRayGrid * float(info.height);
      const glm::vec3 origin = rays.origin_at(x, y), direction = rays.direction_at(x, y);
      alignas(16) RTCRayHit hit;
      if (!first_hit(traced, origin, direction, hit)) continue;
      const Surface surface = surface_at(traced, hit.hit.geomID, hit.hit.primID, hit.hit.u, hit.hit.v, origin,
                                         direction, {hit.hit.Ng_x, hit.hit.Ng_y, hit.hit.Ng_z}, hit.ray.tfar);
      points.push_back({surface, ray_origin_above(traced, surface, rays.eye),
                        glm::distance(surface.position, rays.eye) / traced.scale});
    }
  return points;
}

/// Returns the mean cosine of parallel light on the visible surfaces; it counts 0 where it is blocked.
float mean_light(const TracedScene& traced, const std::vector<VisiblePoint>& points, glm::vec3 direction) {
  float sum = 0.0f;
  for (std::size_t first = 0; first < points.size(); first += kPacket) {
    RayPacket rays;
    std::array<float, kPacket> cosines{};
    for (int k = 0; k < kPacket && first + std::size_t(k) < points.size(); ++k) {
      const VisiblePoint& point = points[first + std::size_t(k)];
      cosines[k] = glm::dot(point.surface.normal, direction);
      if (!(cosines[k] > 0.0f) || !(glm::dot(point.surface.geometric, direction) > 0.0f)) continue;
      rays.set(k, point.start, direction, 0.0f, kRayInfinity);
    }
    rays.find_blocked(traced, Coherence::kIncoherent);
    for (int k = 0; k < kPacket; ++k)
      if (rays.arrives(k)) sum += cosines[k];
  }
  return sum / float(points.size());
}

float median_distance(std::vector<VisiblePoint>& points) {
  const auto middle = points.begin() + std::ptrdiff_t(points.size() / 2);
  std::nth_element(points.begin(), middle, points.end(),
                   [](const VisiblePoint& a, const VisiblePoint& b) { return a.distance < b.distance; });
  return middle->distance;
}

}  // namespace

std::vector<Light> interior_lights(const TracedScene& traced, const PictureInfo& info,
                                   const std::vector<Light>& defaults) {
  std::vector<VisiblePoint> points = visible_surfaces(traced, info);
  if (points.empty() || defaults.empty()) return {};
  if (mean_light(traced, points, defaults[0].direction) >= kMinDefaultCosine) return {};

  const glm::vec3 up = glm::normalize(traced.scene->up);
  const glm::vec3 other = std::abs(up.x) < 0.7f ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1);
  const glm::vec3 across = glm::normalize(glm::cross(up, other)), along = glm::cross(across, up);
  constexpr int kTurns = 16;
  glm::vec3 best = up;
  float best_score = 0.0f, best_light = 0.0f;
  for (const float height_deg : {35.0f, 45.0f, 55.0f, 65.0f, 75.0f, 85.0f})
    for (int turn = 0; turn < kTurns; ++turn) {
      const float height = glm::radians(height_deg), angle = glm::two_pi<float>() * float(turn) / kTurns;
      const glm::vec3 direction = glm::normalize(
          up * std::sin(height) + (across * std::cos(angle) + along * std::sin(angle)) * std::cos(height));
      const float light = mean_light(traced, points, direction);
      const float score = light * (1.0f + kDefaultDirectionBonus * glm::dot(direction, defaults[0].direction)) *
                          (1.0f - kLossPerDeg * std::abs(height_deg - kBestHeightDeg));
      if (score > best_score) best_score = score, best_light = light, best = direction;
    }
  Light light;
  light.casts_shadow = true;
  if (best_light > kMinSunCosine) {
    light.direction = best;
    light.color = kSun;
    light.angle_deg = kSunDeg;
    return {light};
  }
  const float distance = median_distance(points);
  const glm::vec3 eye = inner_camera(info).eye();
  alignas(16) RTCRayHit hit;
  const float ceiling_distance =
      first_hit(traced, traced.unit_of(eye), up, hit) ? hit.ray.tfar / traced.scale : distance;
  light.kind = LightKind::kPoint;
  light.position = eye + up * (kLampHeight * std::min(ceiling_distance, distance));
  light.color = kLamp;
  light.reach = distance;
  light.radius = kLampRadius * distance;
  return {light};
}

}  // namespace umbrage
