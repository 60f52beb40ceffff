#include "rays/shadow_lights.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/trigonometric.hpp>

#include "core/basis.h"

namespace umbrage {

float light_size(const Light& light) {
  return light.kind == LightKind::kPoint ? light.radius : std::tan(glm::radians(0.5f * light.angle_deg));
}

bool casts_visible_shadow(const Light& light) {
  // A head light is at the camera: its shadows are not visible.
  return light.casts_shadow && light.kind != LightKind::kHead;
}

std::pair<glm::vec3, glm::vec3> disc_axes(const glm::vec3& direction) {
  const glm::vec3 axis = glm::normalize(direction);
  const glm::vec3 right = glm::normalize(glm::cross(axis, axis_beside(axis)));
  return {right, glm::cross(right, axis)};
}

void narrow(PenumbraSize& size, const CameraRays& rays, const Surface& surface, float depth, glm::vec3 direction,
            glm::vec3 toward, float radius) {
  // `moved`: the step on the surface from one pixel to the next. Only its component perpendicular to the light's rays
  // counts.
  const auto pixels = [&](glm::vec3 origin_step, glm::vec3 direction_step) {
    glm::vec3 moved = origin_step + depth * direction_step;
    moved -= direction * (glm::dot(surface.normal, moved) / glm::dot(surface.normal, direction));
    const float along = glm::dot(moved, toward);
    const float across = glm::dot(moved, moved) - along * along / glm::dot(toward, toward);
    return across > 0.0f ? radius * radius / across : 0.0f;
  };
  size.across = std::min(size.across, pixels(rays.origin_x, rays.direction_x));
  size.down = std::min(size.down, pixels(rays.origin_y, rays.direction_y));
}

std::vector<ShadowLight> shadow_lights(const TracedScene& traced, const CameraRays& rays, const PictureInfo& info,
                                       const CaptureSettings& settings) {
  const auto brightness = [](const Light& light) { return std::max({light.color.r, light.color.g, light.color.b}); };
  float brightest = 0.0f;
  for (const Light& light : info.lights) brightest = std::max(brightest, brightness(light));
  std::vector<ShadowLight> lights;
  for (int k = 0; k < std::min({int(info.lights.size()), settings.shadows, kMaxShadows}); ++k) {
    const Light& light = info.lights[k];
    if (!casts_visible_shadow(light)) continue;
    const bool point = light.kind == LightKind::kPoint;
    const glm::vec3 where = rays.world_from_view * (point ? light.position * traced.scale : light.direction);
    const float size = light_size(light) * (point ? traced.scale : 1.0f);
    const auto [right, up] = disc_axes(where);
    // Faint lights get fewer rays, because their noise is less visible.
    const float fraction = brightest > 0.0f ? std::sqrt(brightness(light) / brightest) : 1.0f;
    const bool soft = size > 0.0f && settings.shadow_rays > 0;
    const int ray_count =
        soft ? std::clamp(int(std::lround(float(settings.shadow_rays) * fraction)), 1, kDiscPoints) : 0;
    lights.push_back({k, point, point ? where + rays.eye : where, right, up, ray_count, size});
  }
  return lights;
}

DiscPoints disc_points() {
  const auto first_coordinate = [](std::uint32_t n) {  // reverses the bits of n
    std::uint32_t v = 0;
    for (int bit = 0; bit < 32; ++bit) v |= (n >> bit & 1u) << (31 - bit);
    return v;
  };
  const auto second_coordinate = [](std::uint32_t n) {
    std::uint32_t v = 0, direction = 1u << 31;
    for (; n != 0; n >>= 1, direction ^= direction >> 1)
      if (n & 1u) v ^= direction;
    return v;
  };
  constexpr double kScale = 1.0 / 4294967296.0;
  // Permutation of the pixels within a ray's 16 points, different from ray to ray.
  constexpr std::array<std::uint32_t, 4> kPermutation = {0, 3, 1, 2};
  DiscPoints points;
  for (std::uint32_t n = 0; n < kDiscPoints; ++n)
    for (std::uint32_t k = 0; k < std::uint32_t(kPacket); ++k) {
      const std::uint32_t m = n * kPacket + (k ^ kPermutation[n % 4] ^ (kPermutation[n / 4 % 4] << 2));
      const double x = 2.0 * (double(first_coordinate(m)) * kScale) - 1.0,
                   y = 2.0 * (double(second_coordinate(m)) * kScale) - 1.0;
      const bool wide = std::fabs(x) > std::fabs(y);
      const double radius = wide ? x : y, quarter = glm::pi<double>() / 4.0;
      const double angle = wide ? quarter * (y / x) : 2.0 * quarter - (y == 0.0 ? 0.0 : quarter * (x / y));
      points[n][k] = {float(radius * std::cos(angle)), float(radius * std::sin(angle))};
    }
  return points;
}

std::array<glm::vec2, kPacket> disc_border_points() {
  std::array<glm::vec2, kPacket> points;
  for (int k = 0; k < kPacket; ++k) {
    const double angle = 2.0 * glm::pi<double>() * k / kPacket;
    points[k] = {float(std::cos(angle)), float(std::sin(angle))};
  }
  return points;
}

}  // namespace umbrage
