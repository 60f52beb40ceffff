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

}  // namespace umbrage
