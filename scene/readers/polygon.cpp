#include "scene/readers/polygon.h"
#include "scene/fields.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace umbrage {
namespace {

using Index = std::uint32_t;

/// Returns the normal of a polygon, as long as twice its area (Newell).
glm::dvec3 area_normal(std::span<const glm::vec3> corners) {
  glm::dvec3 normal(0.0);
  const glm::dvec3 start(corners[0]);  // small numbers are added with less rounding
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const glm::dvec3 a = glm::dvec3(corners[i]) - start, b = glm::dvec3(corners[i + 1]) - start;
    normal += glm::dvec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
  }
  return normal;
}

/// Returns twice the signed area of a triangle.
double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Appends the triangles of a polygon of `count` corners that meet in its first one; `corner(i)`: number of corner i.
template <class Corner>
void append_fan(Index count, Corner corner, std::vector<Index>& triangles) {
  for (Index i = 2; i < count; ++i) triangles.insert(triangles.end(), {corner(0), corner(i - 1), corner(i)});
}

/// The corner numbers of a whole polygon.
constexpr auto kAllCorners = [](Index i) { return i; };

/// The corners that are not convex, in a grid over the polygon's bounding box.
class CornerGrid {
 public:
  CornerGrid(const std::vector<glm::dvec2>& points, const std::vector<Index>& corners)
      : low_(points[0]), high_(points[0]) {
    for (const glm::dvec2& p : points) {
      low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y)};
      high_ = {std::max(high_.x, p.x), std::max(high_.y, p.y)};
    }
    side_ = std::max(1, int(std::sqrt(double(corners.size()))));
    first_.assign(std::size_t(side_) * std::size_t(side_) + 1, 0);
    const auto cell = [&](Index corner) {
      return row(points[corner].y) * std::size_t(side_) + column(points[corner].x);
    };
    for (const Index corner : corners) ++first_[cell(corner) + 1];
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    std::vector<Index> next(first_.begin(), first_.end() - 1);
    corners_.resize(corners.size());
    for (const Index corner : corners) corners_[next[cell(corner)]++] = corner;
  }

  /// Returns whether `test` is true for any corner in a box. Adds the number of visited cells and corners to `work`.
  template <class Test>
  bool any(const glm::dvec2& low, const glm::dvec2& high, std::size_t& work, Test test) const {
    for (std::size_t y = row(low.y); y <= row(high.y); ++y) {
      const std::size_t start = first_[y * std::size_t(side_) + column(low.x)],
                        stop = first_[y * std::size_t(side_) + column(high.x) + 1];
      work += stop - start + 1;
      if (std::any_of(corners_.begin() + std::ptrdiff_t(start), corners_.begin() + std::ptrdiff_t(stop), test))
        return true;
    }
    return false;
  }

 private:
  std::size_t place(double at, double low, double high) const {
    if (!(high > low)) return 0;
    return std::size_t(std::clamp((at - low) / (high - low) * side_, 0.0, double(side_ - 1)));
  }
  std::size_t column(double x) const { return place(x, low_.x, high_.x); }
  std::size_t row(double y) const { return place(y, low_.y, high_.y); }

  glm::dvec2 low_, high_;
  int side_ = 1;
  std::vector<Index> first_, corners_;
};

/// Cuts corners off a polygon whose orientation is counterclockwise, as long as no other corner is in the triangle.
class EarClipping {
 public:
  explicit EarClipping(const std::vector<glm::dvec2>& points)
      : points_(points), previous_(points.size()), next_(points.size()), is_blocker_(points.size()) {
    const Index count = Index(points.size());
    std::vector<Index> blockers;
    for (Index i = 0; i < count; ++i) {
      previous_[i] = (i + count - 1) % count;
      next_[i] = (i + 1) % count;
    }
    for (Index i = 0; i < count; ++i) {
      is_blocker_[i] = !is_convex(i);
      if (is_blocker_[i]) blockers.push_back(i);
    }
    grid_ = CornerGrid(points, blockers);
  }

  void split(std::vector<Index>& triangles, Poll* poll) {
    constexpr std::size_t kWorkPerPoll = 1 << 16;
    // Bounds the time for polygons whose triangles overlap almost all of their corners.
    const std::size_t max_work = kMaxWorkPerCorner * points_.size();
    std::size_t count = points_.size(), misses = 0, next_poll = kWorkPerPoll;
    Index at = 0;
    while (count > 3 && work_ < max_work) {
      if (work_ > next_poll) {
        if (poll && poll->passing(0.0)) break;
        next_poll = work_ + kWorkPerPoll;
      }
      if (misses < count && !is_ear(at)) {
        at = next_[at];
        ++misses;
        continue;
      }
      if (misses >= count) at = best_without_ears(at, count);
      const Index before = previous_[at], after = next_[at];
      cut(at, triangles);
      // Not the next corner, so that triangles do not all meet in one corner; where ears are rare, search near this
      // one.
      at = misses == 0 ? next_[after] : before;
      misses = 0;
      --count;
    }
    std::vector<Index> polygon;
    for (std::size_t i = 0; i < count; ++i, at = next_[at]) polygon.push_back(at);
    append_fan(
        Index(count), [&](Index i) { return polygon[i]; }, triangles);
  }

 private:
  static constexpr std::size_t kMaxWorkPerCorner = 1024;

  double turn_at(Index i) const { return turn(points_[previous_[i]], points_[i], points_[next_[i]]); }
  bool is_convex(Index i) const { return turn_at(i) > 0.0; }

  bool is_ear(Index i) {
    ++work_;
    if (is_blocker_[i]) return false;
    const Index before = previous_[i], after = next_[i];
    const glm::dvec2 a = points_[before], b = points_[i], c = points_[after];
    const glm::dvec2 low{std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y})},
        high{std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y})};
    return !grid_.any(low, high, work_, [&](Index other) {
      if (!is_blocker_[other] || other == before || other == after) return false;
      const glm::dvec2& p = points_[other];
      // Corners at the place of the triangle's own touch the triangle without entering it.
      if (p == a || p == b || p == c) return false;
      return turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
    });
  }

  /// Returns the corner to cut off where there is no ear: one without area if there is any, else the most convex one.
  Index best_without_ears(Index at, std::size_t count) {
    Index best = at;
    double best_turn = -INFINITY;
    work_ += count;
    for (std::size_t i = 0; i < count; ++i, at = next_[at]) {
      const double here = turn_at(at);
      if (here == 0.0) return at;
      if (here > best_turn) best = at, best_turn = here;
    }
    return best;
  }

  void cut(Index i, std::vector<Index>& triangles) {
    const Index before = previous_[i], after = next_[i];
    triangles.insert(triangles.end(), {before, i, after});
    next_[before] = after;
    previous_[after] = before;
    is_blocker_[i] = false;
    // A corner that has become convex stays so; rounding could only turn it back.
    for (const Index end : {before, after}) is_blocker_[end] = is_blocker_[end] && !is_convex(end);
  }

  const std::vector<glm::dvec2>& points_;
  std::vector<Index> previous_, next_;
  std::vector<std::uint8_t> is_blocker_;
  CornerGrid grid_{{glm::dvec2(0.0)}, {}};
  std::size_t work_ = 0;
};

constexpr std::uint32_t kNotFound = std::numeric_limits<std::uint32_t>::max();

/// Copies the vertex `from` of a mesh to the end of another one.
void copy_vertex(const Mesh& source, std::uint32_t from, Mesh& out) {
  out.positions.push_back(source.positions[from]);
  if (!source.normals.empty()) out.normals.push_back(source.normals[from]);
  if (!source.uvs.empty()) out.uvs.push_back(source.uvs[from]);
  if (!source.colors.empty()) out.colors.push_back(source.colors[from]);
  append_vertex_values(source, from, out);
}

/// Returns a mesh without vertices and triangles, otherwise equal.
Mesh empty_like(const Mesh& mesh) {
  Mesh out;
  out.name = mesh.name;
  out.fields = empty_fields(mesh);
  out.material = mesh.material;
  out.object = mesh.object;
  return out;
}

}  // namespace

void split_polygon(std::span<const glm::vec3> corners, std::vector<Index>& triangles, Poll* poll) {
  const std::size_t count = corners.size();
  if (count < 3) return;
  if (count == 3) {
    triangles.insert(triangles.end(), {0, 1, 2});
    return;
  }
  const glm::dvec3 normal = area_normal(corners);
  const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
  // The plane's axes, such that the polygon is counterclockwise in it.
  int u = x >= y && x >= z ? 1 : y >= z ? 2 : 0, v = (u + 1) % 3;
  if (normal[(v + 1) % 3] < 0.0) std::swap(u, v);
  const auto at = [&](std::size_t i) { return glm::dvec2(corners[i % count][u], corners[i % count][v]); };
  bool is_strictly_convex = true;
  for (std::size_t i = 0; i < count && is_strictly_convex; ++i)
    is_strictly_convex = turn(at(i), at(i + 1), at(i + 2)) > 0.0;
  const double size = x + y + z;
  if (is_strictly_convex || !(size > 0.0) || !std::isfinite(size)) {
    append_fan(Index(count), kAllCorners, triangles);
    return;
  }
  std::vector<glm::dvec2> points(count);
  for (std::size_t i = 0; i < count; ++i) points[i] = at(i);
  EarClipping(points).split(triangles, poll);
}

const std::vector<Index>& FaceSplitter::split(std::span<const Index> vertices, std::span<const glm::vec3> positions) {
  triangles_.clear();
  const auto is_in_range = [&](Index v) { return v < positions.size(); };
  if (vertices.size() > 3 && std::all_of(vertices.begin(), vertices.end(), is_in_range)) {
    corners_.clear();
    for (const Index v : vertices) corners_.push_back(positions[v]);
    split_polygon(corners_, triangles_, poll_);
  } else {
    append_fan(Index(vertices.size()), kAllCorners, triangles_);
  }
  return triangles_;
}

void set_face_attributes(const FaceAttributes& attributes, Mesh& mesh) {
  const bool has_uvs = !attributes.uvs.empty(), has_colors = !attributes.colors.empty();
  if (!has_uvs && !has_colors) return;
  Mesh out = empty_like(mesh);
  out.indices.reserve(mesh.indices.size());
  if (has_uvs) mesh.uvs.clear();
  if (has_colors) mesh.colors.clear();
  // The new vertices of an old one form a list, which is short: most vertices have one or two.
  std::vector<std::uint32_t> first(mesh.positions.size(), kNotFound), next;
  for (std::size_t corner = 0; corner < mesh.indices.size(); ++corner) {
    const std::uint32_t old = mesh.indices[corner];
    if (old >= mesh.positions.size()) {
      out.indices.push_back(kNotFound);
      continue;
    }
    const glm::vec2 uv = has_uvs ? attributes.uvs[corner] : glm::vec2(0.0f);
    const glm::vec3 color = has_colors ? attributes.colors[corner / 3] : glm::vec3(0.0f);
    constexpr int kMaxCompared = 16;  // bounds the work if thousands of faces share one vertex
    std::uint32_t found = kNotFound;
    int compared = 0;
    for (std::uint32_t v = first[old]; v != kNotFound && found == kNotFound && compared < kMaxCompared;
         v = next[v], ++compared)
      if ((!has_uvs || out.uvs[v] == uv) && (!has_colors || out.colors[v] == color)) found = v;
    if (found == kNotFound) {
      found = std::uint32_t(out.positions.size());
      copy_vertex(mesh, old, out);
      if (has_uvs) out.uvs.push_back(uv);
      if (has_colors) out.colors.push_back(color);
      next.push_back(first[old]);
      first[old] = found;
    }
    out.indices.push_back(found);
  }
  for (std::size_t f = 0; f < mesh.fields.size(); ++f)
    if (mesh.fields[f].on_triangles) out.fields[f] = std::move(mesh.fields[f]);
  mesh = std::move(out);
}

std::vector<Mesh> split_by_material(Mesh mesh, const std::vector<int>& materials) {
  std::vector<Mesh> parts;
  std::map<int, std::size_t> part_of;
  for (const int material : materials)
    if (part_of.emplace(material, parts.size()).second) {
      parts.push_back(empty_like(mesh));
      parts.back().material = material;
    }
  if (parts.size() < 2) {
    if (!parts.empty()) mesh.material = parts[0].material;
    parts = {std::move(mesh)};
    return parts;
  }
  std::vector<std::vector<std::size_t>> triangles_of(parts.size());
  for (std::size_t i = 0; i < materials.size(); ++i) triangles_of[part_of[materials[i]]].push_back(i);
  std::vector<std::uint32_t> number(mesh.positions.size(), kNotFound), numbered(mesh.positions.size(), kNotFound);
  for (std::uint32_t p = 0; p < parts.size(); ++p)
    for (const std::size_t triangle : triangles_of[p]) {
      append_triangle_values(mesh, triangle, parts[p]);
      for (std::size_t corner = 3 * triangle; corner < 3 * triangle + 3; ++corner) {
        const std::uint32_t old = mesh.indices[corner];
        if (old >= mesh.positions.size()) {
          parts[p].indices.push_back(kNotFound);
          continue;
        }
        if (numbered[old] != p) {
          numbered[old] = p;
          number[old] = std::uint32_t(parts[p].positions.size());
          copy_vertex(mesh, old, parts[p]);
        }
        parts[p].indices.push_back(number[old]);
      }
    }
  return parts;
}

}  // namespace umbrage
