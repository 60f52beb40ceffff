#include "scene/origin.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "scene/scene.h"

namespace umbrage {

glm::dvec3 scene_origin(const glm::dvec3& low, const glm::dvec3& high) {
  /// Centres within this many sizes of the box stay: a float then resolves a millionth of the size.
  constexpr double kMaxDistance = 16.0;
  const glm::dvec3 center = 0.5 * (low + high), size = high - low;
  const double extent = std::max({size.x, size.y, size.z});
  const double distance = std::max({std::abs(center.x), std::abs(center.y), std::abs(center.z)});
  if (!(extent > 0.0) || !std::isfinite(extent) || !(distance > kMaxDistance * extent)) return glm::dvec3(0.0);
  const double step = std::exp2(std::ceil(std::log2(extent)));
  return glm::round(center / step) * step;
}

void set_origin(const glm::dvec3& origin, Scene& scene) {
  if (origin == scene.origin) return;
  const glm::dvec3 shift = scene.origin - origin;
  const auto move = [&](glm::vec3& position) { position = glm::vec3(glm::dvec3(position) + shift); };
  for (Mesh& mesh : scene.meshes) std::for_each(mesh.positions.begin(), mesh.positions.end(), move);
  for (std::vector<View>* views : {&scene.views, &scene.cameras})
    for (View& view : *views) move(view.eye), move(view.target);
  for (Light& light : scene.lights) move(light.position);
  for (glm::vec3* position : {&scene.bounds_min, &scene.bounds_max, &scene.ground_center}) move(*position);
  scene.origin = origin;
}

glm::dmat4 view_from_file(const glm::mat4& view_from_scene, const glm::dvec3& origin) {
  return glm::translate(glm::dmat4(view_from_scene), -origin);
}

}  // namespace umbrage
