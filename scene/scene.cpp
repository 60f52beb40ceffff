// What a Scene can say of itself.
#include "scene/scene.h"

#include <cmath>

namespace umbrage {

float Scene::radius() const {
  const double x = double(bounds_max.x) - double(bounds_min.x), y = double(bounds_max.y) - double(bounds_min.y),
               z = double(bounds_max.z) - double(bounds_min.z);
  return float(0.5 * std::sqrt(x * x + y * y + z * z));
}

std::size_t Scene::triangle_count() const {
  std::size_t count = 0;
  for (const Mesh& mesh : meshes) count += mesh.indices.size() / 3;
  return count;
}

}  // namespace umbrage
