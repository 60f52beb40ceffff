// Normals and sizes of points, estimated from their nearest neighbours, which a k-d tree finds [Bentley 1975].
// nanoflann 1.4 takes as long (3.7 s for a tree of 1e6 points and twelve neighbours of each, on two cores) and finds
// the same, but builds its tree in one thread and does not order the points in memory.
#include "scene/points.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <numbers>
#include <tuple>

#include "core/basis.h"
#include "core/eigen.h"
#include "core/lists.h"
#include "core/parameters.h"
#include "scene/fields.h"
#include "scene/finish.h"

namespace umbrage {
namespace {

constexpr int kNeighbors = 12;  // enough to fit a plane to noisy points; few enough to lie on one side of a wall
// In units of the spacing: the max half width of a hole that discs close, and the max radius of a disc. A few pinholes
// look better than oversized discs.
constexpr double kMaxHoleHalfWidth = 2.5, kMaxDiscRadius = 1.5;
// At the border of a surface, with no neighbours beyond it: the radius of a disc, in units of the mean distance of the
// kBorderNeighbors nearest neighbours.
constexpr double kBorderRadius = 0.75;
constexpr int kBorderNeighbors = 3;
constexpr float kSlack = 1.05f;  // factor for radii of discs: neighbours on a curved surface are tilted and leave gaps
constexpr float kSphereRadius = 0.5f;  // in units of the spacing: spheres on a grid touch
// The radius of an isolated point's disc would be too large, because its neighbours are far away. Max ratio of a disc's
// radius to the kRadiusQuantile quantile of all radii.
constexpr float kMaxRatioToQuantile = 3.0f;
constexpr double kRadiusQuantile = 0.9;
// Along the normal, neighbours have a fraction of their total variance: 0 on a plane, 1/3 in a cloud. Points lie on
// surfaces if the median of this fraction is at most kFlat.
constexpr float kFlat = 0.06f;

struct IndexedPoint {
  glm::vec3 position;
  std::uint32_t index;
};

bool usable(const glm::vec3& p) {
  return std::abs(p.x) <= kMaxCoordinate && std::abs(p.y) <= kMaxCoordinate && std::abs(p.z) <= kMaxCoordinate;
}

bool usable(float radius) { return radius > 0.0f && radius <= kMaxCoordinate; }

/// Orders points as a balanced k-d tree: the middle of each range splits it along the axis of its largest extent.
struct Tree {
  static constexpr std::size_t kLeaf = 12;  // ranges up to this size are searched linearly
  std::vector<IndexedPoint> points;
  std::vector<std::uint8_t> axes;  // split axis of each range's middle

  explicit Tree(std::vector<IndexedPoint> all) : points(std::move(all)), axes(points.size()) {
    divide(0, points.size());
  }

  void divide(std::size_t begin, std::size_t end) {
    if (end - begin <= kLeaf) return;
    glm::vec3 low = points[begin].position, high = low;
    for (std::size_t i = begin; i < end; ++i) {
      low = glm::min(low, points[i].position);
      high = glm::max(high, points[i].position);
    }
    const glm::vec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return points.begin() + std::ptrdiff_t(i); };
    std::nth_element(at(begin), at(middle), at(end), [axis](const IndexedPoint& a, const IndexedPoint& b) {
      return a.position[axis] != b.position[axis] ? a.position[axis] < b.position[axis] : a.index < b.index;
    });
    axes[middle] = std::uint8_t(axis);
    constexpr std::size_t kMinParallelSize = 20000;
    if (end - begin > kMinParallelSize) {
      tbb::parallel_invoke([&] { divide(begin, middle); }, [&] { divide(middle + 1, end); });
    } else {
      divide(begin, middle);
      divide(middle + 1, end);
    }
  }
};

/// The nearest points found so far, sorted by distance.
struct Nearest {
  glm::vec3 from;
  std::uint32_t self;
  int count = 0;
  std::array<float, kNeighbors> squares{};
  std::array<std::uint32_t, kNeighbors> places{};

  float max_square() const {
    return count < kNeighbors ? std::numeric_limits<float>::infinity() : squares[kNeighbors - 1];
  }

  void consider(const glm::vec3* positions, std::uint32_t place) {
    if (place == self) return;
    const glm::vec3 away = positions[place] - from;
    const float square = glm::dot(away, away);
    if (!(square < max_square())) return;
    int k = count < kNeighbors ? count++ : kNeighbors - 1;
    for (; k > 0 && squares[std::size_t(k) - 1] > square; --k) {
      squares[std::size_t(k)] = squares[std::size_t(k) - 1];
      places[std::size_t(k)] = places[std::size_t(k) - 1];
    }
    squares[std::size_t(k)] = square;
    places[std::size_t(k)] = place;
  }

  void search(const glm::vec3* positions, const std::vector<std::uint8_t>& axes, std::size_t begin, std::size_t end) {
    if (end - begin <= Tree::kLeaf) {
      for (std::size_t i = begin; i < end; ++i) consider(positions, std::uint32_t(i));
      return;
    }
    const std::size_t middle = begin + (end - begin) / 2;
    const float beyond = from[axes[middle]] - positions[middle][axes[middle]];
    const bool first = beyond < 0.0f;
    search(positions, axes, first ? begin : middle + 1, first ? middle : end);
    consider(positions, std::uint32_t(middle));
    if (beyond * beyond < max_square()) search(positions, axes, first ? middle + 1 : begin, first ? end : middle);
  }
};

/// The direction of the smallest variance of points, and the fraction of the total variance in this direction.
struct SmallestVariance {
  glm::vec3 direction{0.0f, 1.0f, 0.0f};
  float fraction = 0.0f;
};

/// Analyses a covariance matrix.
SmallestVariance smallest_variance_of(const glm::dmat3& m) {
  SmallestVariance smallest;
  const double total = m[0][0] + m[1][1] + m[2][2];
  if (!(total > 0.0) || !std::isfinite(total)) return smallest;
  SymmetricMatrix<3> relative;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) relative[std::size_t(i)][std::size_t(j)] = m[i][j] / total;
  const EigenSystem<3> eigen = eigen_of(relative);
  const auto& values = eigen.values;
  const auto axis = [&](std::size_t k) {
    const auto& v = eigen.vectors[k];
    return glm::dvec3(v[0], v[1], v[2]);
  };
  smallest.fraction = float(std::max(0.0, values[0]));
  constexpr double kDistinct = 1e-11;  // min product of the differences from the smallest eigenvalue
  if ((values[1] - values[0]) * (values[2] - values[0]) > kDistinct) {
    smallest.direction = glm::vec3(axis(0));
  } else if (values[2] > values[0]) {  // the points lie on a line: choose one of the directions perpendicular to it
    const glm::dvec3 along = axis(2);
    const glm::dvec3 other = std::abs(along.x) < std::abs(along.y) ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    smallest.direction = glm::vec3(glm::normalize(glm::cross(along, other)));
  }
  return smallest;
}

template <class T>
void reorder(std::vector<T>& values, const std::vector<IndexedPoint>& order) {
  if (values.empty()) return;
  std::vector<T> ordered(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) ordered[i] = values[order[i].index];
  values = std::move(ordered);
}

using Offsets = std::array<glm::dvec3, kNeighbors>;

/// Returns the radius of the smallest disc that covers the point's Voronoi cell in the plane perpendicular to `normal`.
/// Such discs of all points leave no hole. The cell is what remains of a square when each neighbour has cut off the
/// part that is closer to that neighbour. `spacing` is the mean distance of neighbours.
double covering_radius(const Offsets& offsets, int count, const glm::dvec3& normal, double spacing) {
  const glm::dvec3 right = glm::normalize(glm::cross(normal, axis_beside(normal))), up = glm::cross(normal, right);
  struct Corner {
    double x, y;
  };
  constexpr int kMaxCorners = 4 + kNeighbors;
  std::array<Corner, kMaxCorners> cell, cut;
  const double side = kMaxHoleHalfWidth * spacing;
  cell[0] = {-side, -side}, cell[1] = {side, -side}, cell[2] = {side, side}, cell[3] = {-side, side};
  int corners = 4;
  for (int k = 0; k < count; ++k) {
    const double x = glm::dot(offsets[std::size_t(k)], right), y = glm::dot(offsets[std::size_t(k)], up);
    const double half = 0.5 * (x * x + y * y);
    if (!(half > 0.0)) continue;
    int kept = 0;
    for (int i = 0; i < corners; ++i) {
      const Corner a = cell[std::size_t(i)], b = cell[std::size_t(i + 1 == corners ? 0 : i + 1)];
      const double beyond_a = a.x * x + a.y * y - half, beyond_b = b.x * x + b.y * y - half;
      if (beyond_a <= 0.0) cut[std::size_t(kept++)] = a;
      if ((beyond_a < 0.0 && beyond_b > 0.0) || (beyond_a > 0.0 && beyond_b < 0.0)) {
        const double fraction = beyond_a / (beyond_a - beyond_b);
        cut[std::size_t(kept++)] = {a.x + fraction * (b.x - a.x), a.y + fraction * (b.y - a.y)};
      }
    }
    std::swap(cell, cut);
    corners = kept;
  }
  double border_radius = 0.0;
  for (int k = 0; k < std::min(count, kBorderNeighbors); ++k) border_radius += glm::length(offsets[std::size_t(k)]);
  border_radius *= kBorderRadius / std::min(count, kBorderNeighbors);
  double radius = 0.0;
  for (int i = 0; i < corners; ++i) {
    const Corner& c = cell[std::size_t(i)];
    // This corner is on a side of the square: no neighbour in that direction has cut it off.
    const bool open = std::max(std::abs(c.x), std::abs(c.y)) >= side * (1.0 - 1e-9);
    radius = std::max(radius, open ? border_radius : std::hypot(c.x, c.y));
  }
  return std::min(radius, kMaxDiscRadius * spacing);
}

/// Properties of each point, estimated from its neighbours.
struct NeighborEstimates {
  std::vector<float> spacing;  ///< mean distance of neighbours, for points on a surface
  std::vector<float> cover;    ///< see covering_radius
  std::vector<SmallestVariance> planes;
  int count = 0;                         ///< number of neighbours of each point
  std::vector<std::uint32_t> neighbors;  ///< `count` indices of points for each point
};

NeighborEstimates neighbor_estimates_of(const Mesh& mesh) {
  const std::size_t size = mesh.positions.size();
  NeighborEstimates estimates{std::vector<float>(size),
                              std::vector<float>(size),
                              std::vector<SmallestVariance>(size),
                              int(std::min<std::size_t>(kNeighbors, size - 1)),
                              {}};
  if (estimates.count == 0) return estimates;
  estimates.neighbors.resize(size * std::size_t(estimates.count));
  std::vector<IndexedPoint> placed(size);
  for (std::size_t i = 0; i < size; ++i) placed[i] = {mesh.positions[i], std::uint32_t(i)};
  const Tree tree(std::move(placed));
  std::vector<glm::vec3> positions(size);
  for (std::size_t i = 0; i < size; ++i) positions[i] = tree.points[i].position;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, size, 1024), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      Nearest nearest{.from = positions[i], .self = std::uint32_t(i)};
      nearest.search(positions.data(), tree.axes, 0, size);
      const std::size_t out = tree.points[i].index;
      // The disc around a point whose radius is the distance of the farthest of n neighbours has n times the area of
      // the surface per point.
      const double reach = std::sqrt(double(nearest.squares[std::size_t(nearest.count) - 1]));
      const double spacing = reach * std::sqrt(std::numbers::pi / nearest.count);
      estimates.spacing[out] = float(spacing);
      glm::dvec3 sum(0.0);
      Offsets offsets;
      for (int k = 0; k < nearest.count; ++k) {
        offsets[std::size_t(k)] = glm::dvec3(positions[nearest.places[std::size_t(k)]]) - glm::dvec3(positions[i]);
        sum += offsets[std::size_t(k)];
        estimates.neighbors[out * std::size_t(estimates.count) + std::size_t(k)] =
            tree.points[nearest.places[std::size_t(k)]].index;
      }
      const glm::dvec3 middle = sum / double(nearest.count + 1);
      glm::dmat3 variance = glm::outerProduct(middle, middle);  // contribution of the point itself
      for (int k = 0; k < nearest.count; ++k) {
        const glm::dvec3 away = offsets[std::size_t(k)] - middle;
        variance += glm::outerProduct(away, away);
      }
      estimates.planes[out] = smallest_variance_of(variance);
      const glm::vec3 own = mesh.normals.empty() ? glm::vec3(0.0f) : mesh.normals[out];
      const glm::vec3 normal = own == glm::vec3(0.0f) ? estimates.planes[out].direction : own;
      estimates.cover[out] = float(covering_radius(offsets, nearest.count, glm::dvec3(normal), spacing));
    }
  });
  return estimates;
}

bool lie_on_surfaces(const NeighborEstimates& estimates) {
  std::vector<float> fractions(estimates.planes.size());
  std::transform(estimates.planes.begin(), estimates.planes.end(), fractions.begin(),
                 [](const SmallestVariance& plane) { return plane.fraction; });
  return quantile(std::move(fractions), 0.5) <= kFlat;
}

/// Returns the radius of spheres, all of which have one size. On a surface they leave no hole where points are as dense
/// as most. In a cloud they would touch on a grid, and may overlap where points are dense.
float sphere_radius(const NeighborEstimates& estimates) {
  if (lie_on_surfaces(estimates)) return kSlack * quantile(estimates.cover, kRadiusQuantile);
  // The sphere around a point whose radius is the distance of the farthest of n neighbours has n times the volume per
  // point.
  const double reach = quantile(estimates.spacing, 0.5) / std::sqrt(std::numbers::pi / estimates.count);
  const double spacing = reach * std::cbrt(4.0 / 3.0 * std::numbers::pi / estimates.count);
  return float(kSphereRadius * spacing);
}

}  // namespace

std::size_t clean_points(Mesh& mesh) {
  const std::size_t before = mesh.positions.size();
  std::vector<IndexedPoint> order;
  order.reserve(before);
  for (std::size_t i = 0; i < before; ++i)
    if (usable(mesh.positions[i]) && (mesh.radii.empty() || usable(mesh.radii[i])))
      order.push_back({mesh.positions[i], std::uint32_t(i)});
  const std::size_t finite = order.size();
  tbb::parallel_sort(order.begin(), order.end(), [](const IndexedPoint& a, const IndexedPoint& b) {
    return std::tie(a.position.x, a.position.y, a.position.z, a.index) <
           std::tie(b.position.x, b.position.y, b.position.z, b.index);
  });
  order.erase(std::unique(order.begin(), order.end(),
                          [](const IndexedPoint& a, const IndexedPoint& b) { return a.position == b.position; }),
              order.end());
  order = Tree(std::move(order)).points;
  reorder(mesh.positions, order);
  reorder(mesh.normals, order);
  reorder(mesh.colors, order);
  reorder(mesh.radii, order);
  std::vector<std::uint32_t> kept(mesh.fields.empty() ? 0 : order.size());
  for (std::size_t i = 0; i < kept.size(); ++i) kept[i] = order[i].index;
  for (Field& field : mesh.fields) gather_values(kept, field);
  mesh.positions.resize(order.size());
  mesh.uvs.clear();
  mesh.indices.clear();
  return before - finite;
}

void shape_points(Mesh& mesh, const PointSettings& settings, float scene_radius) {
  const std::size_t size = mesh.positions.size();
  if (size == 0) return;
  std::vector<std::size_t> without_normal;
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    const glm::dvec3 normal(mesh.normals[i]);
    const double length = glm::length(normal);
    if (length > kMinNormalLength && std::isfinite(length))
      mesh.normals[i] = glm::vec3(normal / length);
    else {
      mesh.normals[i] = glm::vec3(0.0f);
      without_normal.push_back(i);
    }
  }
  const bool has_normals = !mesh.normals.empty() && without_normal.size() < size;
  const bool given_radii = !mesh.radii.empty();
  const bool given_size = given_radii || settings.size.value > 0.0f;
  const bool only_spheres =
      settings.shape == PointShape::kSpheres || (settings.shape == PointShape::kAuto && mesh.spheres);
  const bool needs_planes = !only_spheres && (!has_normals || !without_normal.empty());
  NeighborEstimates estimates;
  const bool blended = !only_spheres && !given_radii;
  if (needs_planes || !given_size || blended) estimates = neighbor_estimates_of(mesh);
  mesh.spheres = only_spheres;
  if (settings.shape == PointShape::kAuto && !only_spheres && !has_normals) mesh.spheres = !lie_on_surfaces(estimates);
  if (mesh.spheres) {
    mesh.normals.clear();
  } else if (!has_normals) {
    mesh.normals.resize(size);
    for (std::size_t i = 0; i < size; ++i) mesh.normals[i] = estimates.planes[i].direction;
  } else {
    for (const std::size_t i : without_normal) mesh.normals[i] = estimates.planes[i].direction;
  }

  if (given_radii) return;
  if (given_size) {
    const float diameter = absolute_length(settings.size, scene_radius);
    mesh.radii.assign(size, 0.5f * diameter);
    if (!mesh.spheres) blend_discs(mesh, estimates.neighbors, estimates.count);
    return;
  }
  if (estimates.count == 0) {
    mesh.radii.assign(size, scene_radius > 0.0f ? 0.01f * scene_radius : 1.0f);
    return;
  }
  if (mesh.spheres) {
    mesh.radii.assign(size, sphere_radius(estimates));
    return;
  }
  mesh.radii = std::move(estimates.cover);
  const float max = kMaxRatioToQuantile * quantile(mesh.radii, kRadiusQuantile);
  for (float& radius : mesh.radii) radius = kSlack * std::min(radius, max);
  blend_discs(mesh, estimates.neighbors, estimates.count);
}

}  // namespace umbrage
