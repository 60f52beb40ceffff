#include "rays/extra_cameras.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>

#include "rays/camera_rays.h"

namespace umbrage {
namespace {

constexpr int kSides = 4;
constexpr int kGrid = 32;               // grid of rays, per side of the picture, that measure its depth
constexpr float kFreeFraction = 0.95f;  // max fraction of the free distance: keeps the camera out of the wall
constexpr float kMaxTan = 1.428148f;    // tangent of half of 110 degrees
constexpr float kGap = 0.03f;           // distance between c and a surface, as a fraction of the median depth
constexpr float kFarthest = 1.6f;       // max distance of c from the picture's camera, in median depths
constexpr float kClearlyBetter = 1.1f;  // min ratio of free space
constexpr float kNearest = 1e-3f;  // min distance of a camera from c, as a fraction of the picture camera's distance

/// Returns the distance to the first surface, in lengths of `direction`.
float free_distance(const TracedScene& traced, glm::vec3 origin, glm::vec3 direction) {
  alignas(16) RTCRayHit hit;
  return first_hit(traced, origin, direction, hit) ? hit.ray.tfar : kRayInfinity;
}

/// Returns the median depth of the visible surfaces, or the middle of the scene's depth range if nothing is visible.
float median_depth(const TracedScene& traced, const PictureInfo& info) {
  const CameraRays rays = camera_rays(traced, info);
  std::vector<float> depths;
  if (rays_within_limit(rays, info))
    for (int j = 0; j < kGrid; ++j)
      for (int i = 0; i < kGrid; ++i) {
        const float x = (float(i) + 0.5f) / kGrid * float(info.width),
                    y = (float(j) + 0.5f) / kGrid * float(info.height);
        const float depth = free_distance(traced, rays.origin_at(x, y), rays.direction_at(x, y));
        if (std::isfinite(depth) && depth > 0.0f) depths.push_back(depth);
      }
  if (depths.empty()) return 0.5f * (info.depth_min + info.depth_max);
  const auto middle = depths.begin() + std::ptrdiff_t(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return *middle;
}

/// Returns the depths at which the axis meets surfaces, up to `max`.
std::vector<float> crossings_of(const TracedScene& traced, glm::vec3 start, glm::vec3 axis, float max) {
  constexpr int kMaxCrossings = 16;
  constexpr float kStep = 1e-4f;  // offset behind a surface for the next search, as a fraction of `max`
  std::vector<float> crossings;
  for (float from = 0.0f; int(crossings.size()) < kMaxCrossings;) {
    const float depth = from + free_distance(traced, traced.unit_of(start + axis * from), axis * traced.scale);
    if (!(depth < max)) break;
    crossings.push_back(depth);
    from = depth + kStep * max;
  }
  return crossings;
}

/// Returns the unit directions from c to the cameras: behind c, both sides, above.
std::array<glm::vec3, kSides> sides_of(const Camera& camera, glm::vec3 to_eye, glm::vec3 up) {
  constexpr float kNearlyParallel = 0.95f;
  // If the camera looks along `up`, as from above, use the picture's vertical axis: then the sides are at its edges.
  if (!(glm::length(up) > 0.0f) || std::abs(glm::dot(glm::normalize(up), to_eye)) > kNearlyParallel)
    up = glm::vec3(glm::row(camera.view_from_world, 1));
  up = glm::normalize(up);
  const auto rotated = [&](float angle_deg) {
    return glm::vec3(glm::rotate(glm::mat4(1.0f), glm::radians(angle_deg), up) * glm::vec4(to_eye, 0.0f));
  };
  return {rotated(180.0f), rotated(90.0f), rotated(-90.0f), up};
}

}  // namespace

std::vector<Camera> extra_cameras(const TracedScene& traced, const PictureInfo& info, int count) {
  if (count == 0) return {};
  const PictureInfo inner = inner_info(info);
  const Camera& main_camera = inner.camera;
  const bool orthographic = main_camera.projection == Projection::kOrthographic;
  const glm::mat3 world_from_view = glm::transpose(glm::mat3(main_camera.view_from_world));
  const glm::vec2 middle(0.5f * (main_camera.left + main_camera.right), 0.5f * (main_camera.bottom + main_camera.top));
  const glm::vec2 half(0.5f * (main_camera.right - main_camera.left), 0.5f * (main_camera.top - main_camera.bottom));
  const glm::vec3 start =
      main_camera.eye() + (orthographic ? world_from_view * glm::vec3(middle, 0.0f) : glm::vec3(0.0f));
  const glm::vec3 axis = world_from_view * (orthographic ? glm::vec3(0, 0, -1) : glm::vec3(middle, -1.0f));
  const float axis_length = glm::length(axis);
  const std::array<glm::vec3, kSides> sides = sides_of(main_camera, -axis / axis_length, traced.scene->up);

  // Candidates for c: slightly in front of the median depth, and slightly in front of or behind each surface on the
  // axis. A candidate replaces the one before it only if it has clearly more free space: a drape in the middle
  // would otherwise be close behind c.
  const float median = median_depth(traced, inner);
  const float gap = kGap * median, main_distance = (median - gap) * axis_length;
  std::vector<float> depths = {median - gap};
  const std::vector<float> crossings = crossings_of(traced, start, axis, kFarthest * median);
  if (!crossings.empty()) depths.push_back(crossings[0] - std::min(gap, 0.5f * crossings[0]));
  for (const float crossing : crossings) depths.push_back(crossing + gap);
  std::array<bool, kSides> is_open_at_camera{};
  for (int k = 0; k < kSides; ++k)
    is_open_at_camera[k] = !std::isfinite(free_distance(traced, traced.unit_of(start), sides[k]));
  glm::vec3 c = start + axis * depths[0];
  float best_space = -1.0f;
  std::array<float, kSides> distances{};
  for (const float depth : depths) {
    const glm::vec3 point = start + axis * depth;
    std::array<float, kSides> free{};
    float space = 0.0f;
    bool outside_room = false;
    for (int k = 0; k < kSides; ++k) {
      const float ahead = free_distance(traced, traced.unit_of(point), sides[k]) / traced.scale;
      // A camera outside a room sees nothing in it, so c must not have an open direction that the picture's camera does
      // not have. k = 0, straight ahead, is exempt.
      outside_room = outside_room || (k > 0 && !std::isfinite(ahead) && !is_open_at_camera[k]);
      free[k] = std::max(std::min(kFreeFraction * ahead, depth * axis_length), kNearest * main_distance);
      // The square root prefers some space for each camera to much space for one of them.
      space += std::sqrt(std::min(free[k] / main_distance, 1.0f));
    }
    if (!(space > best_space * kClearlyBetter) || (outside_room && best_space >= 0.0f)) continue;
    best_space = space;
    c = point;
    distances = free;
  }

  const float depth = glm::dot(c - start, axis) / (axis_length * axis_length);
  std::vector<Camera> cameras;
  for (int k = 0; k < std::min(count, kSides); ++k) {
    const glm::vec3 eye = c + sides[k] * distances[k];
    Camera camera = perspective_camera(eye, c, traced.scene->up, 90.0f, 1.0f);
    camera.projection = main_camera.projection;
    float window_scale = 1.0f;
    if (!orthographic) window_scale = std::min(depth / distances[k], kMaxTan / std::max(half.x, half.y));
    camera.left = -half.x * window_scale;
    camera.right = half.x * window_scale;
    camera.bottom = -half.y * window_scale;
    camera.top = half.y * window_scale;
    cameras.push_back(with_guard({.width = inner.width, .height = inner.height, .camera = camera}, info.guard).camera);
  }
  return cameras;
}

}  // namespace umbrage
