// Normals and sizes of points, estimated from their nearest neighbours, which a k-d tree finds [Bentley 1975].
// Each leaf searches for the neighbours of all its points at once.
#include "scene/points.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <numbers>
#include <tuple>

#include "core/basis.h"
#include "core/lists.h"
#include "core/parameters.h"
#include "scene/fields.h"
#include "scene/finish.h"
#include "scene/strays.h"

namespace umbrage {
namespace {

constexpr int kNeighbors = 12;  // enough to fit a plane to noisy points; few enough to lie on one side of a wall
// In units of the spacing: the max half width of a hole that discs close, and the max radius of a disc. A few pinholes
// look better than oversized discs.
constexpr float kMaxHoleHalfWidth = 2.5f, kMaxDiscRadius = 1.5f;
// At the border of a surface, with no neighbours beyond it: the radius of a disc, in units of the mean distance of the
// kBorderNeighbors nearest neighbours.
constexpr float kBorderRadius = 0.75f;
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

/// A range of points in the order of a balanced k-d tree: its halves are the next nodes. Ranges of kLeaf or fewer
/// points are leaves.
struct TreeRange {
  static constexpr std::uint32_t kLeaf = 32;
  std::uint32_t begin, end;

  bool is_leaf() const { return end - begin <= kLeaf; }
  std::uint32_t middle() const { return begin + (end - begin) / 2; }
  /// Calls visit(half) for both halves, in parallel if they are large.
  template <class Visit>
  void for_halves(const Visit& visit) const {
    constexpr std::uint32_t kMinParallelSize = 20000;
    const TreeRange halves[] = {{begin, middle()}, {middle(), end}};
    if (end - begin > kMinParallelSize)
      tbb::parallel_invoke([&] { visit(0, halves[0]); }, [&] { visit(1, halves[1]); });
    else
      visit(0, halves[0]), visit(1, halves[1]);
  }
};

/// Puts points in the order of a k-d tree: the middle of each range splits it along the axis of its largest extent.
void order_as_tree(std::vector<IndexedPoint>& points, const TreeRange& range) {
  if (range.is_leaf()) return;
  SceneBox box;
  for (std::uint32_t i = range.begin; i < range.end; ++i) extend(box, points[i].position);
  const glm::vec3 size = box.high - box.low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto at = [&](std::uint32_t i) { return points.begin() + std::ptrdiff_t(i); };
  std::nth_element(
      at(range.begin), at(range.middle()), at(range.end), [axis](const IndexedPoint& a, const IndexedPoint& b) {
        return a.position[axis] != b.position[axis] ? a.position[axis] < b.position[axis] : a.index < b.index;
      });
  range.for_halves([&](int, const TreeRange& half) { order_as_tree(points, half); });
}

/// The nearest points found so far of one point.
struct Nearest {
  glm::vec3 from;
  std::uint32_t self;
  /// Ascending: the bits of the squared distance, which as those of a positive float have its order, above the index.
  std::array<std::uint64_t, kNeighbors> keys;

  float square(int k) const { return std::bit_cast<float>(std::uint32_t(keys[std::size_t(k)] >> 32)); }
  std::uint32_t index(int k) const { return std::uint32_t(keys[std::size_t(k)]); }
  float max_square() const { return square(kNeighbors - 1); }

  void consider(float square, std::uint32_t index) {
    const std::uint64_t key = std::uint64_t(std::bit_cast<std::uint32_t>(square)) << 32 | index;
    if (key >= keys.back() || index == self) return;
    for (std::size_t k = kNeighbors - 1; k > 0; --k) keys[k] = std::min(keys[k], std::max(keys[k - 1], key));
    keys[0] = std::min(keys[0], key);
  }
};

/// Returns the squared distance of two boxes.
float square_between(const SceneBox& a, const SceneBox& b) {
  const glm::vec3 gap = glm::max(glm::max(a.low - b.high, b.low - a.high), glm::vec3(0.0f));
  return glm::dot(gap, gap);
}

/// Finds the nearest neighbours of points in the order of a k-d tree.
class NeighborSearch {
 public:
  explicit NeighborSearch(const std::vector<glm::vec3>& positions) : positions_(positions) {
    // One more leaf, since distances are computed for as many points as a leaf may have.
    for (std::size_t axis = 0; axis < 3; ++axis) {
      coordinates_[axis].resize(positions.size() + TreeRange::kLeaf);
      for (std::size_t i = 0; i < positions.size(); ++i) coordinates_[axis][i] = positions[i][int(axis)];
    }
    boxes_.resize(4 * positions.size() / TreeRange::kLeaf + 4);
    set_boxes(0, all());
  }

  /// Calls visit(nearest) for each point, in parallel.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for_each_of(0, all(), visit);
  }

 private:
  TreeRange all() const { return {0, std::uint32_t(positions_.size())}; }
  static std::size_t child(std::size_t node, int half) { return 2 * node + 1 + std::size_t(half); }

  void set_boxes(std::size_t node, const TreeRange& range) {
    SceneBox& box = boxes_[node];
    if (range.is_leaf()) {
      for (std::uint32_t i = range.begin; i < range.end; ++i) extend(box, positions_[i]);
      return;
    }
    range.for_halves([&](int half, const TreeRange& part) { set_boxes(child(node, half), part); });
    for (const int half : {0, 1})
      extend(box, boxes_[child(node, half)].low), extend(box, boxes_[child(node, half)].high);
  }

  template <class Visit>
  void for_each_of(std::size_t node, const TreeRange& range, const Visit& visit) const {
    if (!range.is_leaf()) {
      range.for_halves([&](int half, const TreeRange& part) { for_each_of(child(node, half), part, visit); });
      return;
    }
    constexpr std::uint64_t kNone = std::uint64_t(std::bit_cast<std::uint32_t>(std::numeric_limits<float>::infinity()))
                                    << 32;
    Leaf leaf{.box = boxes_[node], .range = range};
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      Nearest& nearest = leaf.nearest[i - range.begin];
      nearest.from = positions_[i], nearest.self = i;
      nearest.keys.fill(kNone);
    }
    search(leaf, leaf.box, range);
    search(leaf, 0, all());
    for (std::uint32_t i = 0; i < range.end - range.begin; ++i) visit(leaf.nearest[i]);
  }

  /// A leaf whose points search.
  struct Leaf {
    SceneBox box;
    TreeRange range;
    float max_square = 0.0f;
    std::array<Nearest, TreeRange::kLeaf> nearest;
  };

  /// Searches a leaf for those points that may have neighbours there.
  void search(Leaf& leaf, const SceneBox& box, const TreeRange& range) const {
    leaf.max_square = 0.0f;
    for (std::uint32_t i = 0; i < leaf.range.end - leaf.range.begin; ++i) {
      Nearest& nearest = leaf.nearest[i];
      leaf.max_square = std::max(leaf.max_square, nearest.max_square());
      if (square_between({nearest.from, nearest.from}, box) > nearest.max_square()) continue;
      std::array<float, TreeRange::kLeaf> squares;
      const float *x = &coordinates_[0][range.begin], *y = &coordinates_[1][range.begin],
                  *z = &coordinates_[2][range.begin];
      for (std::uint32_t k = 0; k < TreeRange::kLeaf; ++k) {
        const float dx = x[k] - nearest.from.x, dy = y[k] - nearest.from.y, dz = z[k] - nearest.from.z;
        squares[k] = dx * dx + dy * dy + dz * dz;
      }
      for (std::uint32_t k = 0; k < range.end - range.begin; ++k)
        if (squares[k] <= nearest.max_square()) nearest.consider(squares[k], range.begin + k);
    }
  }

  /// Searches the other leaves of a node, the nearer half first.
  void search(Leaf& leaf, std::size_t node, const TreeRange& range) const {
    if (range.begin == leaf.range.begin && range.end == leaf.range.end) return;
    if (range.is_leaf()) return search(leaf, boxes_[node], range);
    const TreeRange halves[] = {{range.begin, range.middle()}, {range.middle(), range.end}};
    const float squares[] = {square_between(leaf.box, boxes_[child(node, 0)]),
                             square_between(leaf.box, boxes_[child(node, 1)])};
    const int first = squares[1] < squares[0];
    for (const int half : {first, 1 - first})
      if (squares[half] < leaf.max_square) search(leaf, child(node, half), halves[half]);
  }

  const std::vector<glm::vec3>& positions_;
  std::array<std::vector<float>, 3> coordinates_;
  std::vector<SceneBox> boxes_;  ///< of each node: see child
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
  glm::dmat3 a = m / total;
  // The smallest root of its characteristic polynomial, x^3 - x^2 + sum x - determinant, from below by Newton's method.
  const double sum = a[0][0] * a[1][1] - a[0][1] * a[0][1] + a[0][0] * a[2][2] - a[0][2] * a[0][2] + a[1][1] * a[2][2] -
                     a[1][2] * a[1][2];
  const double determinant = glm::determinant(a);
  constexpr int kMaxSteps = 40;  // a double root halves the error of each step
  constexpr double kPrecision = 1e-13;
  double root = 0.0, slope = sum;  // the slope is the product of the differences of the other eigenvalues from it
  for (int k = 0; k < kMaxSteps && slope > 0.0; ++k) {
    const double step = (determinant - ((root - 1.0) * root + sum) * root) / slope;
    if (!(step > kPrecision)) break;
    root += step;
    slope = (3.0 * root - 2.0) * root + sum;
  }
  smallest.fraction = float(root);
  for (int axis = 0; axis < 3; ++axis) a[axis][axis] -= root;
  constexpr double kDistinct = 1e-11;  // min slope
  const auto longest = [](const glm::dvec3& x, const glm::dvec3& y, const glm::dvec3& z) {
    const glm::dvec3& of_two = glm::dot(x, x) >= glm::dot(y, y) ? x : y;
    return glm::dot(of_two, of_two) >= glm::dot(z, z) ? of_two : z;
  };
  if (slope > kDistinct) {
    smallest.direction =
        glm::vec3(glm::normalize(longest(glm::cross(a[0], a[1]), glm::cross(a[1], a[2]), glm::cross(a[2], a[0]))));
  } else if (const glm::dvec3 along = longest(a[0], a[1], a[2]); glm::dot(along, along) > 0.0) {
    // The points lie on a line: choose one of the directions perpendicular to it.
    smallest.direction = glm::vec3(glm::normalize(glm::cross(along, axis_beside(glm::normalize(along)))));
  }
  return smallest;
}

template <class T>
void reorder(std::vector<T>& values, const std::vector<IndexedPoint>& order) {
  if (values.empty()) return;
  std::vector<T> ordered(order.size());
  tbb::parallel_for(std::size_t(0), order.size(), [&](std::size_t i) { ordered[i] = values[order[i].index]; });
  values = std::move(ordered);
}

using Offsets = std::array<glm::vec3, kNeighbors>;

/// Returns the radius of the smallest disc that covers the point's Voronoi cell in the plane perpendicular to `normal`.
/// Such discs of all points leave no hole. The cell is what remains of a square when each neighbour has cut off the
/// part that is closer to that neighbour. `spacing` is the mean distance of neighbours.
float covering_radius(const Offsets& offsets, int count, const glm::vec3& normal, float spacing) {
  const auto [right, up] = axes_of_disc(normal);
  constexpr int kMaxCorners = 4 + kNeighbors;
  std::array<glm::vec2, kMaxCorners> cell, cut;
  std::array<float, kMaxCorners> beyond;
  const float side = kMaxHoleHalfWidth * spacing;
  cell[0] = {-side, -side}, cell[1] = {side, -side}, cell[2] = {side, side}, cell[3] = {-side, side};
  int corners = 4;
  for (int k = 0; k < count; ++k) {
    const glm::vec2 toward(glm::dot(offsets[std::size_t(k)], right), glm::dot(offsets[std::size_t(k)], up));
    const float half = 0.5f * glm::dot(toward, toward);
    if (!(half > 0.0f)) continue;
    float farthest = 0.0f;
    for (int i = 0; i < corners; ++i) {
      beyond[std::size_t(i)] = glm::dot(cell[std::size_t(i)], toward) - half;
      farthest = std::max(farthest, beyond[std::size_t(i)]);
    }
    if (farthest <= 0.0f) continue;
    int kept = 0;
    for (int i = 0; i < corners; ++i) {
      const auto a = std::size_t(i), b = std::size_t(i + 1 == corners ? 0 : i + 1);
      if (beyond[a] <= 0.0f) cut[std::size_t(kept++)] = cell[a];
      if ((beyond[a] < 0.0f && beyond[b] > 0.0f) || (beyond[a] > 0.0f && beyond[b] < 0.0f))
        cut[std::size_t(kept++)] = cell[a] + beyond[a] / (beyond[a] - beyond[b]) * (cell[b] - cell[a]);
    }
    std::swap(cell, cut);
    corners = kept;
  }
  float border_radius = 0.0f;
  for (int k = 0; k < std::min(count, kBorderNeighbors); ++k) border_radius += glm::length(offsets[std::size_t(k)]);
  border_radius *= kBorderRadius / float(std::min(count, kBorderNeighbors));
  float radius = 0.0f;
  for (int i = 0; i < corners; ++i) {
    const glm::vec2 c = cell[std::size_t(i)];
    // This corner is on a side of the square: no neighbour in that direction has cut it off.
    const bool open = std::max(std::abs(c.x), std::abs(c.y)) >= side * (1.0f - 1e-6f);
    radius = std::max(radius, open ? border_radius : glm::length(c));
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
  const int count = estimates.count;
  if (count == 0) return estimates;
  estimates.neighbors.resize(size * std::size_t(count));
  NeighborSearch(mesh.positions).for_each([&](const Nearest& nearest) {
    const std::size_t i = nearest.self;
    const float reach = std::sqrt(nearest.square(count - 1)), scale = reach > 0.0f ? 1.0f / reach : 0.0f;
    // The disc around a point whose radius is the distance of the farthest of n neighbours has n times the area of
    // the surface per point.
    const float spacing = std::sqrt(std::numbers::pi_v<float> / float(count));  // in units of the reach, as all here
    Offsets offsets;
    glm::dvec3 sum(0.0);
    glm::dmat3 variance(0.0);
    for (int k = 0; k < count; ++k) {
      const std::uint32_t other = nearest.index(k);
      estimates.neighbors[i * std::size_t(count) + std::size_t(k)] = other;
      offsets[std::size_t(k)] = (mesh.positions[other] - nearest.from) * scale;
      const glm::dvec3 away(offsets[std::size_t(k)]);
      sum += away;
      variance += glm::outerProduct(away, away);
    }
    estimates.spacing[i] = spacing * reach;
    estimates.planes[i] = smallest_variance_of(variance - glm::outerProduct(sum, sum) / double(count + 1));
    const glm::vec3 own = mesh.normals.empty() ? glm::vec3(0.0f) : mesh.normals[i];
    const glm::vec3 normal = own == glm::vec3(0.0f) ? estimates.planes[i].direction : own;
    estimates.cover[i] = reach * covering_radius(offsets, count, normal, spacing);
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
  order_as_tree(order, {0, std::uint32_t(order.size())});
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
