#include "core/light.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace umbrage {

bool AmbientShape::even() const {
  return std::all_of(by_color.begin(), by_color.end(), [](const glm::mat4& m) { return m == glm::mat4(0.0f); });
}

glm::vec3 AmbientShape::at(glm::vec3 n) const {
  const glm::vec4 v(n, 1.0f);
  return {glm::dot(v, by_color[0] * v), glm::dot(v, by_color[1] * v), glm::dot(v, by_color[2] * v)};
}

AmbientShape turned(const AmbientShape& shape, const glm::mat3& rotation) {
  const glm::mat4 turn(rotation);
  AmbientShape out;
  for (int c = 0; c < 3; ++c) out.by_color[c] = turn * shape.by_color[c] * glm::transpose(turn);
  return out;
}

std::array<float, 3 * kSkyFactors> sky_factors(const AmbientShape& shape) {
  std::array<float, 3 * kSkyFactors> factors{};
  for (int c = 0; c < 3; ++c) {
    const glm::mat4& m = shape.by_color[c];
    const glm::vec3 first = glm::vec3(m[3]) * (2.0f / (2.0f / 3.0f));
    const glm::mat3 second = glm::mat3(m) * 4.0f;
    const float mean = (second[0][0] + second[1][1] + second[2][2]) / 3.0f;
    const float of_color[kSkyFactors] = {
        first.x,      first.y,      first.z,     second[0][0] - mean, second[1][1] - mean, second[2][2] - mean,
        second[0][1], second[1][2], second[2][0]};
    std::copy_n(of_color, kSkyFactors, factors.begin() + kSkyFactors * c);
  }
  return factors;
}

glm::vec3 sky_radiance(const std::array<float, 3 * kSkyFactors>& factors, glm::vec3 d, float first, float second) {
  glm::vec3 radiance;
  for (int c = 0; c < 3; ++c) {
    const float* f = factors.data() + kSkyFactors * c;
    radiance[c] = (f[0] * d.x + f[1] * d.y + f[2] * d.z) * first +
                  (f[3] * d.x * d.x + f[4] * d.y * d.y + f[5] * d.z * d.z +
                   2.0f * (f[6] * d.x * d.y + f[7] * d.y * d.z + f[8] * d.z * d.x)) *
                      second;
  }
  return radiance;
}

}  // namespace umbrage
