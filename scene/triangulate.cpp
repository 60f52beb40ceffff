// Triangles of polygons and of regions of the plane.
#include "scene/triangulate.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <numeric>

namespace umbrage {
namespace {

using Index = std::uint32_t;
using PlanePoints = std::span<const glm::dvec2>;

/// Returns twice the signed area of a triangle.
double twice_area_of(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

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

/// Appends the triangles of a polygon of `count` corners that meet in its first one; `corner(i)`: number of corner i.
template <class Corner>
void append_fan(Index count, Corner corner, std::vector<Index>& triangles) {
  for (Index i = 2; i < count; ++i) triangles.insert(triangles.end(), {corner(0), corner(i - 1), corner(i)});
}

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

  double turn_at(Index i) const { return twice_area_of(points_[previous_[i]], points_[i], points_[next_[i]]); }
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
      return twice_area_of(a, b, p) >= 0.0 && twice_area_of(b, c, p) >= 0.0 && twice_area_of(c, a, p) >= 0.0;
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

/// A rectangle around a loop.
struct LoopBox {
  glm::dvec2 low{std::numeric_limits<double>::max()}, high{std::numeric_limits<double>::lowest()};

  LoopBox(PlanePoints points, const Loop& loop) {
    for (const Index k : loop) low = glm::min(low, points[k]), high = glm::max(high, points[k]);
  }
  bool contains(const LoopBox& other) const {
    return glm::min(low, other.low) == low && glm::max(high, other.high) == high;
  }
};

bool is_inside(PlanePoints points, const Loop& loop, const glm::dvec2& p) {
  bool inside = false;
  for (std::size_t k = 0, last = loop.size() - 1; k < loop.size(); last = k++) {
    const glm::dvec2 &a = points[loop[last]], &b = points[loop[k]];
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * ((p.y - a.y) / (b.y - a.y))) inside = !inside;
  }
  return inside;
}

/// Returns whether a loop lies in another one. Loops may touch, so that several of its points decide.
bool is_loop_inside(PlanePoints points, const Loop& outer, const Loop& loop) {
  constexpr std::size_t kVotes = 5;
  int votes = 0;
  const std::size_t step = std::max<std::size_t>(loop.size() / kVotes, 1);
  for (std::size_t k = 0; k < loop.size(); k += step)
    votes += is_inside(points, outer, 0.5 * (points[loop[k]] + points[loop[(k + 1) % loop.size()]])) ? 1 : -1;
  return votes > 0;
}

/// A polygon and its holes.
struct Region {
  Loop outer;               ///< counterclockwise
  std::vector<Loop> holes;  ///< clockwise
};

/// Divides the inside of loops into polygons with holes.
std::vector<Region> regions_of(PlanePoints points, const std::vector<Loop>& loops) {
  std::vector<double> area;
  std::vector<LoopBox> box;
  for (const Loop& loop : loops) area.push_back(twice_area(points, loop)), box.emplace_back(points, loop);
  std::vector<std::size_t> by_size(loops.size());  // the loops around a loop are before it
  std::iota(by_size.begin(), by_size.end(), std::size_t(0));
  std::stable_sort(by_size.begin(), by_size.end(),
                   [&](std::size_t a, std::size_t b) { return std::abs(area[a]) > std::abs(area[b]); });
  std::vector<Region> regions;
  constexpr auto kNoRegion = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> region_of(loops.size(), kNoRegion);  // of loops around one
  for (std::size_t i = 0; i < by_size.size(); ++i) {
    const std::size_t k = by_size[i];
    if (area[k] == 0.0) continue;
    bool is_hole = false;
    std::size_t around = kNoRegion;  // the smallest one
    for (std::size_t j = 0; j < i; ++j) {
      const std::size_t other = by_size[j];
      if (area[other] == 0.0 || !box[other].contains(box[k]) || !is_loop_inside(points, loops[other], loops[k]))
        continue;
      is_hole = !is_hole;
      if (region_of[other] != kNoRegion) around = region_of[other];
    }
    Loop loop = loops[k];
    if ((area[k] > 0.0) == is_hole) std::reverse(loop.begin(), loop.end());
    if (is_hole && around != kNoRegion) {
      regions[around].holes.push_back(std::move(loop));
    } else if (!is_hole) {
      region_of[k] = regions.size();
      regions.push_back({std::move(loop), {}});
    }
  }
  return regions;
}

/// A polygon to which holes are joined: where it visits a point twice, its corners there differ.
struct Ring {
  PlanePoints points;
  Loop corners;

  const glm::dvec2& at(std::size_t k) const { return points[corners[k % corners.size()]]; }

  /// Returns whether a corner sees a point in its interior angle.
  bool opens_to(std::size_t k, const glm::dvec2& p) const {
    const glm::dvec2 &before = at(k + corners.size() - 1), &after = at(k + 1);
    const bool left_of_first = twice_area_of(before, at(k), p) > 0.0,
               left_of_second = twice_area_of(at(k), after, p) > 0.0;
    return twice_area_of(before, at(k), after) >= 0.0 ? left_of_first && left_of_second
                                                      : left_of_first || left_of_second;
  }

  /// Returns the corner that a bridge can join to the first point of a hole, its leftmost one; -1: none.
  std::ptrdiff_t bridge_to(const Loop& hole) const {
    const glm::dvec2 h = points[hole[0]];
    double x = std::numeric_limits<double>::lowest();
    std::ptrdiff_t best = -1;
    // The nearest edge to the left of the hole; its end that is farther to the left may be visible.
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const glm::dvec2 &a = at(k), &b = at(k + 1);
      if (a == h && opens_to(k, points[hole[1]])) return std::ptrdiff_t(k);
      if (a.y < h.y || b.y > h.y || a.y == b.y) continue;
      const double crossing = a.x + (b.x - a.x) * ((h.y - a.y) / (b.y - a.y));
      if (crossing > h.x || crossing <= x) continue;
      x = crossing;
      best = std::ptrdiff_t(a.x < b.x ? k : (k + 1) % corners.size());
    }
    if (best < 0) return best;
    // Corners in the triangle of the hole, the edge and its end hide this end: the one at the smallest angle is
    // visible.
    const glm::dvec2 on_edge(x, h.y), end = at(std::size_t(best));
    const glm::dvec2 &a = end.y > h.y ? on_edge : h, &b = end.y > h.y ? h : on_edge;
    double smallest = std::numeric_limits<double>::max();
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const glm::dvec2& p = at(k);
      if (p.x > h.x || p.x < end.x || p == h || !(twice_area_of(a, b, p) >= 0.0 && twice_area_of(b, end, p) >= 0.0) ||
          !(twice_area_of(end, a, p) >= 0.0 && opens_to(k, h)))
        continue;
      const double angle = std::abs(p.y - h.y) / (h.x - p.x);
      if (angle < smallest || (angle == smallest && p.x > at(std::size_t(best)).x))
        best = std::ptrdiff_t(k), smallest = angle;
    }
    return best;
  }

  /// Joins a hole by an edge from its first point and one back, or where they touch.
  void join(const Loop& hole) {
    const std::ptrdiff_t corner = bridge_to(hole);
    if (corner < 0) return;
    const Index from = corners[std::size_t(corner)];
    const bool touches = points[from] == points[hole[0]];
    Loop path(hole.begin() + touches, hole.end());
    path.push_back(hole[0]);
    if (!touches) path.push_back(from);
    corners.insert(corners.begin() + corner + 1, path.begin(), path.end());
  }
};

/// Returns a region as one polygon.
Loop polygon_of(PlanePoints points, Region region) {
  const auto is_left = [&](Index a, Index b) {
    return std::pair(points[a].x, points[a].y) < std::pair(points[b].x, points[b].y);
  };
  for (Loop& hole : region.holes)
    std::rotate(hole.begin(), std::min_element(hole.begin(), hole.end(), is_left), hole.end());
  std::sort(region.holes.begin(), region.holes.end(),
            [&](const Loop& a, const Loop& b) { return is_left(a[0], b[0]); });
  Ring ring{points, std::move(region.outer)};
  for (const Loop& hole : region.holes) ring.join(hole);
  return std::move(ring.corners);
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
    is_strictly_convex = twice_area_of(at(i), at(i + 1), at(i + 2)) > 0.0;
  const double size = x + y + z;
  if (is_strictly_convex || !(size > 0.0) || !std::isfinite(size)) {
    append_fan(
        Index(count), [](Index i) { return i; }, triangles);
    return;
  }
  std::vector<glm::dvec2> points(count);
  for (std::size_t i = 0; i < count; ++i) points[i] = at(i);
  EarClipping(points).split(triangles, poll);
}

double twice_area(std::span<const glm::dvec2> points, const Loop& loop) {
  double area = 0.0;
  for (std::size_t k = 1; k + 1 < loop.size(); ++k)
    area += twice_area_of(points[loop[0]], points[loop[k]], points[loop[k + 1]]);
  return area;
}

std::vector<std::array<Index, 3>> triangulate(std::span<const glm::dvec2> points, const std::vector<Loop>& loops) {
  std::vector<std::array<Index, 3>> triangles;
  for (Region& region : regions_of(points, loops)) {
    const Loop polygon = polygon_of(points, std::move(region));
    std::vector<glm::dvec2> corners;
    for (const Index k : polygon) corners.push_back(points[k]);
    std::vector<Index> numbers;
    EarClipping(corners).split(numbers, nullptr);
    for (std::size_t i = 0; i < numbers.size(); i += 3) {
      const Index a = polygon[numbers[i]], b = polygon[numbers[i + 1]], c = polygon[numbers[i + 2]];
      if (a != b && b != c && c != a) triangles.push_back({a, b, c});
    }
  }
  return triangles;
}

}  // namespace umbrage
