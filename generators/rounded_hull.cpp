// Rounded hulls: the hull's planes are moved inwards by the bevel, and a sphere of that radius is added again
// (Minkowski sum). Faces become flat polygons, edges cylinder strips, corners sphere patches. Suitable for a few dozen
// points: planes and corners are found by testing all triples.
#include "generators/shapes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace umbrage {

namespace {

using glm::dvec3;
using glm::vec3;

/// Points closer to a plane than this fraction of the hull's size count as points on it. It is well above the rounding
/// of coordinates.
constexpr double kTolerance = 1e-5;

/// Corners closer than this fraction of the size are merged. It is much smaller than kTolerance, because planes are
/// exact here, and where four planes nearly meet, the two corners must stay separate.
constexpr double kCornerTolerance = 1e-9;

struct Plane {
  dvec3 normal;
  double offset;  ///< the inside is where dot(normal, p) < offset
};

/// A vertex of the hull.
struct Corner {
  dvec3 position;
  std::vector<int> planes;  ///< planes that meet here, counter-clockwise seen from outside
};

/// Returns the hull's planes. Points within the tolerance of a plane count as points on it. Planes with equal points
/// are merged.
std::vector<Plane> hull_planes(std::span<const vec3> points, double size, double tolerance) {
  std::vector<Plane> planes;
  std::vector<std::vector<bool>> members;
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      for (std::size_t k = j + 1; k < n; ++k) {
        const bool known = std::ranges::any_of(
            members, [&](const std::vector<bool>& member) { return member[i] && member[j] && member[k]; });
        if (known) continue;
        dvec3 normal = glm::cross(dvec3(points[j]) - dvec3(points[i]), dvec3(points[k]) - dvec3(points[i]));
        const double length = glm::length(normal);
        if (!(length > 10.0 * tolerance * size)) continue;
        normal /= length;
        double offset = glm::dot(normal, dvec3(points[i]));
        double low = 0.0, high = 0.0;
        std::vector<bool> member(n);
        for (std::size_t p = 0; p < n; ++p) {
          const double height = glm::dot(normal, dvec3(points[p])) - offset;
          low = std::min(low, height);
          high = std::max(high, height);
          member[p] = std::abs(height) <= tolerance;
        }
        if (high > tolerance && low < -tolerance) continue;
        if (high > tolerance) {
          normal = -normal;
          offset = -offset;
        }
        planes.push_back({normal, offset});
        members.push_back(std::move(member));
      }
  return planes;
}

/// Sorts `items` by the angle of their points around `axis`.
template <class PointOf>
void sort_around(std::vector<int>& items, dvec3 axis, PointOf&& point_of) {
  dvec3 centre(0.0);
  for (const int item : items) centre += point_of(item);
  centre /= double(items.size());
  const dvec3 right = glm::normalize(point_of(items[0]) - centre - axis * glm::dot(axis, point_of(items[0]) - centre));
  const dvec3 up = glm::cross(axis, right);
  std::vector<std::pair<double, int>> order;
  for (const int item : items) {
    const dvec3 out = point_of(item) - centre;
    order.emplace_back(std::atan2(glm::dot(out, up), glm::dot(out, right)), item);
  }
  std::ranges::sort(order);
  for (std::size_t i = 0; i < items.size(); ++i) items[i] = order[i].second;
}

std::vector<Corner> hull_corners(const std::vector<Plane>& planes, double tolerance) {
  std::vector<Corner> corners;
  const int n = int(planes.size());
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j)
      for (int k = j + 1; k < n; ++k) {
        const dvec3 jk = glm::cross(planes[j].normal, planes[k].normal);
        const double volume = glm::dot(planes[i].normal, jk);
        if (std::abs(volume) < 1e-9) continue;
        const dvec3 at = (planes[i].offset * jk + planes[j].offset * glm::cross(planes[k].normal, planes[i].normal) +
                          planes[k].offset * glm::cross(planes[i].normal, planes[j].normal)) /
                         volume;
        const auto outside = [&](const Plane& plane) { return glm::dot(plane.normal, at) > plane.offset + tolerance; };
        if (std::ranges::any_of(planes, outside)) continue;
        const auto same = std::ranges::find_if(
            corners, [&](const Corner& corner) { return glm::distance(corner.position, at) < 10.0 * tolerance; });
        Corner& corner = same == corners.end() ? corners.emplace_back(Corner{at, {}}) : *same;
        for (const int plane : {i, j, k})
          if (std::ranges::find(corner.planes, plane) == corner.planes.end()) corner.planes.push_back(plane);
      }
  for (Corner& corner : corners) {
    dvec3 out(0.0);
    for (const int plane : corner.planes) out += planes[plane].normal;
    sort_around(corner.planes, glm::normalize(out), [&](int plane) { return planes[plane].normal; });
  }
  return corners;
}

struct Builder {
  Mesh mesh;
  double bevel;

  std::uint32_t add(dvec3 corner, dvec3 normal) {
    mesh.positions.push_back(vec3(corner + bevel * normal));
    mesh.normals.push_back(vec3(normal));
    return std::uint32_t(mesh.positions.size() - 1);
  }
  /// Adds a triangle unless two of its points coincide.
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const auto& p = mesh.positions;
    if (p[a] == p[b] || p[b] == p[c] || p[c] == p[a]) return;
    mesh.indices.insert(mesh.indices.end(), {a, b, c});
  }
};

/// Returns the unit vector at `step` of `steps` on the arc between two planes' normals. Exchanging the planes gives
/// bitwise identical vectors in reverse order.
dvec3 on_arc(const std::vector<Plane>& planes, int from, int to, int step, int steps) {
  if (from > to) {
    std::swap(from, to);
    step = steps - step;
  }
  if (step == 0) return planes[from].normal;
  if (step == steps) return planes[to].normal;
  const dvec3 a = planes[from].normal, b = planes[to].normal;
  const double angle = std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0)), t = double(step) / double(steps);
  return glm::normalize(std::sin((1.0 - t) * angle) * a + std::sin(t * angle) * b);
}

/// Adds the sphere patch of a corner: rings from the arcs between neighbouring planes' normals to the patch's middle.
void add_corner(const std::vector<Plane>& planes, const Corner& corner, int segments, Builder& builder) {
  const int rings = std::max(1, (segments + 1) / 2);
  const int count = int(corner.planes.size());
  std::vector<dvec3> outline;
  for (int i = 0; i < count; ++i)
    for (int s = 0; s < segments; ++s)
      outline.push_back(on_arc(planes, corner.planes[i], corner.planes[(i + 1) % count], s, segments));
  dvec3 middle(0.0);
  for (const dvec3& normal : outline) middle += normal;
  middle = glm::normalize(middle);
  const std::uint32_t first = std::uint32_t(builder.mesh.positions.size()),
                      outline_size = std::uint32_t(outline.size());
  for (int r = 0; r < rings; ++r)
    for (const dvec3& normal : outline) {
      const double t = double(r) / double(rings);
      builder.add(corner.position, r == 0 ? normal : glm::normalize(glm::mix(normal, middle, t)));
    }
  const std::uint32_t tip = builder.add(corner.position, middle);
  for (int r = 0; r < rings; ++r)
    for (std::uint32_t i = 0; i < outline_size; ++i) {
      const std::uint32_t j = (i + 1) % outline_size, outer = first + std::uint32_t(r) * outline_size,
                          inner = outer + outline_size;
      if (r + 1 == rings) {
        builder.triangle(outer + i, outer + j, tip);
      } else {
        builder.triangle(outer + i, outer + j, inner + j);
        builder.triangle(outer + i, inner + j, inner + i);
      }
    }
}

}  // namespace

Mesh rounded_hull(std::span<const vec3> points, float bevel, int segments) {
  if (points.empty()) return {};
  vec3 low = points[0], high = points[0];
  for (const vec3& p : points) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const double size = glm::length(dvec3(high) - dvec3(low)), tolerance = kTolerance * size;
  segments = std::max(segments, 0);
  Builder builder{{}, segments > 0 ? double(bevel) : 0.0};

  std::vector<Plane> planes = hull_planes(points, size, tolerance);
  for (Plane& plane : planes) plane.offset -= builder.bevel;
  const std::vector<Corner> corners = hull_corners(planes, kCornerTolerance * size);

  for (int p = 0; p < int(planes.size()); ++p) {
    std::vector<int> ring;
    for (int c = 0; c < int(corners.size()); ++c)
      if (std::ranges::find(corners[c].planes, p) != corners[c].planes.end()) ring.push_back(c);
    if (ring.size() < 3) continue;
    sort_around(ring, planes[p].normal, [&](int c) { return corners[c].position; });
    std::vector<std::uint32_t> face;
    face.reserve(ring.size());
    for (const int c : ring) face.push_back(builder.add(corners[c].position, planes[p].normal));
    for (std::size_t i = 2; i < face.size(); ++i) builder.triangle(face[0], face[i - 1], face[i]);

    if (segments == 0) continue;

    // The strip over each edge is made by the plane with the lower index.
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Corner &a = corners[ring[i]], &b = corners[ring[(i + 1) % ring.size()]];
      const auto shared = std::ranges::find_if(
          a.planes, [&](int other) { return other != p && std::ranges::find(b.planes, other) != b.planes.end(); });
      if (shared == a.planes.end() || *shared < p) continue;
      std::uint32_t last_a = 0, last_b = 0;
      for (int s = 0; s <= segments; ++s) {
        const dvec3 normal = on_arc(planes, p, *shared, s, segments);
        const std::uint32_t next_a = builder.add(a.position, normal), next_b = builder.add(b.position, normal);
        if (s > 0) {
          builder.triangle(last_a, next_a, next_b);
          builder.triangle(last_a, next_b, last_b);
        }
        last_a = next_a;
        last_b = next_b;
      }
    }
  }

  if (segments == 0) return std::move(builder.mesh);

  for (const Corner& corner : corners) add_corner(planes, corner, segments, builder);
  return std::move(builder.mesh);
}

}  // namespace umbrage
