#include "scene/strays.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

namespace umbrage {
namespace {

constexpr std::size_t kManyPoints = 100;
constexpr double kFraction = 0.01;       // of vertices that may be bad numbers, at each end of an axis
constexpr double kNoiseFraction = 0.1;   // of points that may be noise, at each end of an axis
constexpr std::size_t kMinOfNoise = 8;   // at most one point in eight is noise
constexpr float kCell = 8.0f;            // cells in which points of noise are alone, in spacings of a surface's points
constexpr float kFar = 3.0f;             // where noise is noticed, in sizes of the box of most points
constexpr float kNear = 0.7f;            // where it begins then
constexpr float kGap = 5.0f;             // empty space around the rest, in its sizes
constexpr float kNeedle = 30.0f;         // where a vertex is a bad number, in sizes of the box of most vertices
constexpr std::size_t kMinOfStrays = 3;  // at most one item in three is a stray
constexpr std::size_t kSamples = 2048;

float size_of(const SceneBox& box) {
  const glm::vec3 size = box.high - box.low;
  return std::max({size.x, size.y, size.z});
}

SceneBox grown(const SceneBox& box, float by) { return {box.low - by, box.high + by}; }

bool contains(const SceneBox& box, const glm::vec3& p) {
  return glm::all(glm::lessThanEqual(box.low, p)) && glm::all(glm::lessThanEqual(p, box.high));
}

bool contains(const SceneBox& box, const SceneBox& other) {
  return contains(box, other.low) && contains(box, other.high);
}

/// Calls visit(mesh, box, corners) for each triangle and point; `corners`: three indices of vertices; null for a point.
template <class Visit>
void for_each_item(const Scene& scene, Visit visit) {
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.points)
      for (const glm::vec3& p : mesh.positions) visit(mesh, SceneBox{p, p}, nullptr);
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      SceneBox box;
      for (std::size_t k = i; k < i + 3; ++k) extend(box, mesh.positions[mesh.indices[k]]);
      visit(mesh, box, &mesh.indices[i]);
    }
  }
}

/// Returns the positions of some vertices or points, evenly chosen.
std::vector<glm::vec3> sample_of(const Scene& scene, bool points) {
  std::size_t count = 0, next = 0, passed = 0;
  for (const Mesh& mesh : scene.meshes) count += mesh.points == points ? mesh.positions.size() : 0;
  const std::size_t step = count / kSamples + 1;
  std::vector<glm::vec3> sample;
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.points != points) continue;
    for (; next < passed + mesh.positions.size(); next += step) sample.push_back(mesh.positions[next - passed]);
    passed += mesh.positions.size();
  }
  return sample;
}

std::vector<float> sorted_along(int axis, const std::vector<glm::vec3>& positions) {
  std::vector<float> sorted(positions.size());
  std::transform(positions.begin(), positions.end(), sorted.begin(), [axis](const glm::vec3& p) { return p[axis]; });
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

/// Returns the box, axis by axis, of all but the lowest and the highest `fraction` of the positions.
SceneBox box_of_most(const std::vector<glm::vec3>& sample, double fraction) {
  SceneBox box;
  const std::size_t cut = std::size_t(fraction * double(sample.size()));
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<float> sorted = sorted_along(axis, sample);
    box.low[axis] = sorted[cut], box.high[axis] = sorted[sorted.size() - 1 - cut];
  }
  return box;
}

/// Returns the size of the smallest interval, of the axis where it is largest, that holds two thirds of the positions.
float size_of_core(const std::vector<glm::vec3>& sample) {
  float size = 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<float> sorted = sorted_along(axis, sample);
    const std::size_t held = (sorted.size() - 1) - sorted.size() / kMinOfStrays;
    float smallest = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i + held < sorted.size(); ++i) smallest = std::min(smallest, sorted[i + held] - sorted[i]);
    size = std::max(size, smallest);
  }
  return size;
}

/// Returns whether most of some points are alone in a cell of a grid of this size, as noise is and a part is not.
bool are_scattered(const std::vector<glm::vec3>& points, float cell) {
  std::vector<std::uint64_t> cells;
  for (const glm::vec3& p : points) {
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis)
      key = (key ^ std::uint64_t(std::int64_t(std::floor(double(p[axis]) / double(cell))))) * 0x9e3779b97f4a7c15ull;
    cells.push_back(key);
  }
  std::sort(cells.begin(), cells.end());
  const auto count = std::unique(cells.begin(), cells.end()) - cells.begin();
  constexpr std::size_t kMost = 3, kOf = 4;  // more than three of four are alone
  return kOf * std::size_t(count) > kMost * points.size();
}

/// Returns the box of the points without noise; empty if there is none.
SceneBox box_without_noise(const Scene& scene, const SceneBox& all) {
  const std::size_t count = scene.point_count();
  if (count < kManyPoints) return {};
  const SceneBox most = box_of_most(sample_of(scene, true), kNoiseFraction);
  const float size = size_of(most);
  if (!(size > 0.0f) || contains(grown(most, kFar * size), all)) return {};
  const SceneBox near = grown(most, kNear * size);
  std::vector<glm::vec3> outside;
  for (const Mesh& mesh : scene.meshes)
    if (mesh.points)
      for (const glm::vec3& p : mesh.positions)
        if (!contains(near, p)) outside.push_back(p);
  const bool is_noise = !outside.empty() && outside.size() * kMinOfNoise <= count &&
                        are_scattered(outside, kCell * size / std::sqrt(float(count)));
  return is_noise ? near : SceneBox{};
}

/// A part of an axis that is covered by triangles and points without a gap.
struct StrayCluster {
  float low, high;
  std::size_t count;
};

/// Joins intervals to clusters that are at least `gap` apart.
std::vector<StrayCluster> clusters_of(std::vector<StrayCluster> intervals, float gap) {
  std::sort(intervals.begin(), intervals.end(),
            [](const StrayCluster& a, const StrayCluster& b) { return a.low < b.low; });
  std::vector<StrayCluster> clusters;
  for (const StrayCluster& next : intervals) {
    if (clusters.empty() || next.low - clusters.back().high > gap) {
      clusters.push_back(next);
      continue;
    }
    clusters.back().high = std::max(clusters.back().high, next.high);
    clusters.back().count += next.count;
  }
  return clusters;
}

/// The clusters along an axis, from `first` to `last` of which the rest reaches.
struct AxisClusters {
  std::vector<StrayCluster> clusters;
  std::size_t first = 0, last = 0;
  float low() const { return clusters[first].low; }
  float high() const { return clusters[last].high; }
  /// Extends the rest by clusters within a distance. Returns whether there was one.
  bool extend(float distance) {
    const std::size_t before = last - first;
    while (first > 0 && !(clusters[first].low - clusters[first - 1].high > distance)) --first;
    while (last + 1 < clusters.size() && !(clusters[last + 1].low - clusters[last].high > distance)) ++last;
    return last - first != before;
  }
};

/// Returns the box outside of which a single vertex of a triangle is a bad number, not a part of the scene.
SceneBox box_of_vertices(const Scene& scene) {
  const std::vector<glm::vec3> sample = sample_of(scene, false);
  if (sample.empty()) return {};
  const SceneBox most = box_of_most(sample, kFraction);
  return grown(most, kNeedle * size_of(most));
}

/// Returns whether one corner of a triangle is far from the two others and nearly all vertices.
bool is_needle(const Mesh& mesh, const std::uint32_t* corners, const SceneBox& vertices) {
  int inside = 0;
  for (int k = 0; k < 3; ++k) inside += contains(vertices, mesh.positions[corners[k]]);
  return inside == 2;
}

/// Returns the box of what is not separated from most of the items by a large gap. `noise_free`: the box of the points
/// that count, as one item; empty: all points are items. Empty if all are needles.
SceneBox box_without_gaps(const Scene& scene, const SceneBox& noise_free, float core, SceneBox points,
                          std::size_t point_count) {
  std::array<std::vector<StrayCluster>, 3> intervals;
  const auto add = [&](const SceneBox& box, std::size_t count) {
    for (int axis = 0; axis < 3; ++axis) intervals[std::size_t(axis)].push_back({box.low[axis], box.high[axis], count});
  };
  const SceneBox vertices = box_of_vertices(scene);
  for_each_item(scene, [&](const Mesh& mesh, const SceneBox& box, const std::uint32_t* corners) {
    if (corners ? !is_needle(mesh, corners, vertices) : noise_free.is_empty()) add(box, 1);
  });
  if (point_count > 0) add(points, point_count);
  if (intervals[0].empty()) return {};
  std::array<AxisClusters, 3> axes;
  for (int axis = 0; axis < 3; ++axis) {
    AxisClusters& on = axes[std::size_t(axis)];
    on.clusters = clusters_of(std::move(intervals[std::size_t(axis)]), kGap * core);
    const auto largest =
        std::max_element(on.clusters.begin(), on.clusters.end(),
                         [](const StrayCluster& a, const StrayCluster& b) { return a.count < b.count; });
    on.first = on.last = std::size_t(largest - on.clusters.begin());
  }
  const auto box = [&] {
    return SceneBox{{axes[0].low(), axes[1].low(), axes[2].low()}, {axes[0].high(), axes[1].high(), axes[2].high()}};
  };
  for (bool extended = true; extended;) {
    extended = false;
    for (AxisClusters& axis : axes) extended = axis.extend(kGap * size_of(box())) || extended;
  }
  return box();
}

/// Counts what is outside of a box, and finds the box of the rest.
Strays strays_outside(const Scene& scene, const SceneBox& noise_free, const SceneBox& without_gaps) {
  Strays strays;
  std::vector<glm::vec3> far;
  for_each_item(scene, [&](const Mesh& mesh, const SceneBox& box, const std::uint32_t*) {
    const bool inside =
        contains(without_gaps, box) && (!mesh.points || noise_free.is_empty() || contains(noise_free, box));
    if (inside) {
      extend(strays.rest, box.low), extend(strays.rest, box.high);
      return;
    }
    ++(mesh.points ? strays.points : strays.triangles);
    far.push_back(0.5f * box.low + 0.5f * box.high);
  });
  const glm::vec3 center = 0.5f * strays.rest.low + 0.5f * strays.rest.high;
  for (const glm::vec3& p : far) strays.distance = std::max(strays.distance, glm::distance(p, center));
  return strays;
}

}  // namespace

Strays find_strays(const Scene& scene, const SceneBox& all) {
  Strays none{.rest = all};
  if (all.is_empty() || scene.meshes.empty()) return none;
  const SceneBox noise_free = box_without_noise(scene, all);
  SceneBox points;
  std::size_t point_count = 0;
  if (!noise_free.is_empty()) {
    for (const Mesh& mesh : scene.meshes)
      if (mesh.points)
        for (const glm::vec3& p : mesh.positions)
          if (contains(noise_free, p)) extend(points, p), ++point_count;
  }
  // A gap is larger than the rest, and so than the smallest interval of two thirds of it.
  std::vector<glm::vec3> sample = sample_of(scene, false);
  for (const glm::vec3& p : sample_of(scene, true))
    if (noise_free.is_empty() || contains(noise_free, p)) sample.push_back(p);
  const float core = size_of_core(sample);
  SceneBox without_gaps = all;
  if (size_of(all) > kGap * core) without_gaps = box_without_gaps(scene, noise_free, core, points, point_count);
  if (without_gaps.is_empty()) without_gaps = all;
  if (noise_free.is_empty() && contains(without_gaps, all)) return none;
  const Strays strays = strays_outside(scene, noise_free, without_gaps);
  const std::size_t items = scene.triangle_count() + scene.point_count();
  const bool few = strays.any() && (strays.triangles + strays.points) * kMinOfStrays <= items;
  return few && size_of(strays.rest) > 0.0f ? strays : none;
}

bool is_within(const glm::vec3& point, float radius, const SceneBox& rest) {
  return contains(grown(rest, radius), point);
}

bool is_in_bounds(const Scene& scene, const glm::vec3& p) { return contains({scene.bounds_min, scene.bounds_max}, p); }

std::string strays_text(const Strays& strays) {
  const std::size_t count = strays.triangles + strays.points;
  const std::string what = strays.points == 0      ? count == 1 ? "triangle" : "triangles"
                           : strays.triangles == 0 ? count == 1 ? "point" : "points"
                                                   : "triangles and points";
  const float ratio = strays.distance / (0.5f * glm::length(strays.rest.high - strays.rest.low));
  return fmt::format(
      "{} {} {} far from the rest, up to {} times its radius from its centre, and outside of the default picture",
      count, what, count == 1 ? "lies" : "lie",
      ratio < 1e6f ? fmt::format("{:.0f}", ratio) : fmt::format("{:.0e}", ratio));
}

}  // namespace umbrage
