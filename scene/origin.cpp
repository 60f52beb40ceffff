#include "scene/origin.h"

#include <algorithm>
#include <cmath>

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

}  // namespace umbrage
