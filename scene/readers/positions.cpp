#include "scene/readers/positions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "scene/origin.h"

namespace umbrage {
namespace {

struct Box {
  glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
};

bool is_finite(const glm::dvec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

Box box_of(const std::vector<glm::dvec3>& positions) {
  Box box;
  for (const glm::dvec3& p : positions)
    if (is_finite(p)) box = {glm::min(box.low, p), glm::max(box.high, p)};
  return box;
}

/// Returns the box of most positions: per axis, of all but the lowest and highest tenth of a sample.
Box box_of_most(const std::vector<glm::dvec3>& positions) {
  constexpr std::size_t kSamples = 4096;
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> sample;
    for (std::size_t i = 0, step = positions.size() / kSamples + 1; i < positions.size(); i += step)
      if (is_finite(positions[i])) sample.push_back(positions[i][axis]);
    if (sample.empty()) return box;
    std::sort(sample.begin(), sample.end());
    const std::size_t cut = sample.size() / 10;
    box.low[axis] = sample[cut], box.high[axis] = sample[sample.size() - 1 - cut];
  }
  return box;
}

}  // namespace

void set_positions(const std::vector<glm::dvec3>& positions, Mesh& mesh, Scene& scene) {
  const Box all = box_of(positions);
  glm::dvec3 origin = scene_origin(all.low, all.high);
  // With positions far from the rest, the box of all may hold the file's origin though the model is far from it. Only
  // then: the box of most is smaller, so that its origin alone would move models that floats hold precisely.
  constexpr double kStray = 100.0;  // times the size of the box of most
  if (origin == glm::dvec3(0.0) && all.low.x <= all.high.x) {
    const Box most = box_of_most(positions);
    const glm::dvec3 size = all.high - all.low, size_of_most = most.high - most.low;
    if (std::max({size.x, size.y, size.z}) > kStray * std::max({size_of_most.x, size_of_most.y, size_of_most.z}))
      origin = scene_origin(most.low, most.high);
  }
  scene.origin = origin;
  mesh.positions.resize(positions.size());
  std::transform(positions.begin(), positions.end(), mesh.positions.begin(),
                 [&](const glm::dvec3& p) { return glm::vec3(p - origin); });
}

}  // namespace umbrage
