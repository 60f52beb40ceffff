#include "apps/compare/environments.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>

namespace umbrage {
namespace {

using glm::vec3;

/// Returns a direction by its azimuth, from x towards y, and its elevation.
vec3 direction_at(float azimuth_deg, float elevation_deg) {
  const float a = glm::radians(azimuth_deg), e = glm::radians(elevation_deg);
  return {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
}

/// Returns a soft light: cos^power of the angle to its middle.
float lobe(vec3 direction, vec3 middle, float power) {
  return std::pow(std::max(glm::dot(direction, middle), 0.0f), power);
}

/// Returns `below` under the horizon and `above` above it, with a soft edge 6 degrees wide.
vec3 with_horizon(vec3 direction, vec3 below, vec3 above) {
  return glm::mix(below, above, glm::smoothstep(-0.05f, 0.05f, direction.z));
}

vec3 clear_sky(vec3 d) {
  const vec3 horizon(0.75f, 0.85f, 1.0f), zenith(0.15f, 0.3f, 0.7f), ground(0.18f, 0.15f, 0.12f);
  const vec3 sky = glm::mix(horizon, zenith, std::sqrt(std::max(d.z, 0.0f)));
  return with_horizon(d, ground, sky + vec3(1.5f, 1.4f, 1.1f) * lobe(d, direction_at(40.0f, 50.0f), 8.0f));
}

vec3 studio(vec3 d) {
  return vec3(0.08f) + vec3(4.0f, 3.8f, 3.5f) * lobe(d, direction_at(-45.0f, 40.0f), 16.0f) +
         vec3(0.9f, 1.0f, 1.2f) * lobe(d, direction_at(70.0f, 20.0f), 4.0f) +
         vec3(3.0f, 3.1f, 3.3f) * lobe(d, direction_at(170.0f, 50.0f), 16.0f);
}

vec3 sunset(vec3 d) {
  const vec3 sun = vec3(3.0f, 1.6f, 0.6f) * lobe(d, direction_at(20.0f, 9.0f), 32.0f);
  return with_horizon(d, vec3(0.04f), vec3(0.08f, 0.09f, 0.14f) + sun);
}

}  // namespace

const std::array<Environment, kEnvironments>& environments() {
  static const std::array<Environment, kEnvironments> all = {
      {{"clear sky", clear_sky}, {"studio", studio}, {"sunset", sunset}}};
  return all;
}

EnvironmentAmbient ambient_of(const Environment& environment, const glm::mat3& axes) {
  constexpr int kRows = 128, kColumns = 256;  // of a grid of equal solid angles
  EnvironmentAmbient ambient;
  std::array<vec3, 3> first{};
  std::array<glm::mat3, 3> second{glm::mat3(0.0f), glm::mat3(0.0f), glm::mat3(0.0f)};
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      const float z = 1.0f - 2.0f * (float(row) + 0.5f) / kRows, across = std::sqrt(1.0f - z * z);
      const float angle = 2.0f * std::numbers::pi_v<float> * (float(column) + 0.5f) / kColumns;
      const vec3 direction(across * std::cos(angle), across * std::sin(angle), z);
      const vec3 radiance = environment.radiance(direction) / float(kRows * kColumns);
      ambient.mean += radiance;
      for (int c = 0; c < 3; ++c) {
        first[c] += direction * radiance[c];
        second[c] += (glm::outerProduct(direction, direction) - glm::mat3(1.0f / 3.0f)) * radiance[c];
      }
    }
  // Radiance is mean + l.d + d'Qd with l = 3 <L d> and Q = 15/2 <L (d d' - 1/3)>; irradiance has 2/3 of l and 1/4 of Q
  // [Ramamoorthi and Hanrahan 2001].
  for (int c = 0; c < 3; ++c) {
    glm::mat4 m(second[c] * (7.5f / 4.0f));
    m[3] = glm::vec4(first[c], 0.0f);
    for (int i = 0; i < 3; ++i) m[i][3] = first[c][i];
    m[3][3] = 0.0f;
    ambient.shape.by_color[c] = m;
  }
  ambient.shape = turned(ambient.shape, axes);
  return ambient;
}

Image environment_light(const Image& picture, const Image& normals, const EnvironmentAmbient& ambient,
                        const std::vector<std::string>& names) {
  const Plane& ao = picture.plane("ao");
  const std::array<const Plane*, 3> normal = {&normals.plane("normal.x"), &normals.plane("normal.y"),
                                              &normals.plane("normal.z")};
  const std::array<const Plane*, 3> indirect = {picture.find("indirect.r"), picture.find("indirect.g"),
                                                picture.find("indirect.b")};
  Image light(ao.width, ao.height);
  for (std::size_t c = 0; c < 3; ++c) {
    Plane& plane = light.add(names[c]);
    plane = Plane(ao.width, ao.height, 0.0f);
    for (int y = 0; y < ao.height; ++y)
      for (int x = 0; x < ao.width; ++x) {
        const vec3 n(normal[0]->at(x, y), normal[1]->at(x, y), normal[2]->at(x, y));
        const float of_normal = std::max(ambient.mean[int(c)] + ambient.shape.at(n)[int(c)], 0.0f);
        plane.at(x, y) = of_normal * ao.at(x, y) + (indirect[c] ? indirect[c]->at(x, y) : 0.0f);
      }
  }
  return light;
}

}  // namespace umbrage
