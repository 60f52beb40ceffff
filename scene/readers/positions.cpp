#include "scene/readers/positions.h"

#include <algorithm>

namespace umbrage {

void OriginFinder::add_sample(const glm::dvec3& p) {
  constexpr std::size_t kMaxSamples = 8192;
  sample_.push_back(p);
  if (sample_.size() < kMaxSamples) return;
  for (std::size_t i = 0; i < kMaxSamples / 2; ++i) sample_[i] = sample_[2 * i];
  sample_.resize(kMaxSamples / 2);
  step_ *= 2;
}

glm::dvec3 OriginFinder::origin() const {
  if (count_ == 0) return glm::dvec3(0.0);
  const glm::dvec3 of_all = scene_origin(low_, high_);
  if (of_all != glm::dvec3(0.0)) return of_all;
  // With positions far from the rest, the box of all may hold the file's origin though the model is far from it. Only
  // then: the box of most is smaller, so that its origin alone would move models that floats hold precisely.
  glm::dvec3 low, high;  // the box of most: per axis, of all but the lowest and highest tenth of the sample, rounded up
  std::vector<double> sorted;
  for (int axis = 0; axis < 3; ++axis) {
    sorted.clear();
    for (const glm::dvec3& p : sample_) sorted.push_back(p[axis]);
    std::sort(sorted.begin(), sorted.end());
    const std::size_t cut = std::min((sorted.size() + 9) / 10, (sorted.size() - 1) / 2);
    low[axis] = sorted[cut], high[axis] = sorted[sorted.size() - 1 - cut];
  }
  constexpr double kStray = 100.0;  // times the size of the box of most
  const glm::dvec3 size = high_ - low_, size_of_most = high - low;
  const bool has_strays =
      std::max({size.x, size.y, size.z}) > kStray * std::max({size_of_most.x, size_of_most.y, size_of_most.z});
  return has_strays ? scene_origin(low, high) : glm::dvec3(0.0);
}

void set_positions(const std::vector<glm::dvec3>& positions, Mesh& mesh, Scene& scene) {
  OriginFinder finder;
  for (const glm::dvec3& p : positions) finder.add(p);
  scene.origin = finder.origin();
  mesh.positions.resize(positions.size());
  std::transform(positions.begin(), positions.end(), mesh.positions.begin(),
                 [&](const glm::dvec3& p) { return glm::vec3(p - scene.origin); });
}

}  // namespace umbrage
