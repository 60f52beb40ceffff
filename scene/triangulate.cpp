#include "scene/triangulate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace umbrage {
namespace {

using PlanePoints = std::span<const glm::dvec2>;
using CornerTriple = std::array<std::uint32_t, 3>;

/// Returns twice the signed area of a triangle.
double cross_of(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// A rectangle around a loop.
struct LoopBox {
  glm::dvec2 low{std::numeric_limits<double>::max()}, high{std::numeric_limits<double>::lowest()};
  bool contains(const LoopBox& other) const {
    return low.x <= other.low.x && low.y <= other.low.y && high.x >= other.high.x && high.y >= other.high.y;
  }
};

LoopBox box_of(PlanePoints points, const Loop& loop) {
  LoopBox box;
  for (const std::uint32_t k : loop) {
    box.low = {std::min(box.low.x, points[k].x), std::min(box.low.y, points[k].y)};
    box.high = {std::max(box.high.x, points[k].x), std::max(box.high.y, points[k].y)};
  }
  return box;
}

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

void set_direction(PlanePoints points, bool counterclockwise, Loop& loop) {
  if ((twice_area(points, loop) > 0.0) != counterclockwise) std::reverse(loop.begin(), loop.end());
}

/// Divides the inside of loops into polygons with holes.
std::vector<Region> regions_of(PlanePoints points, const std::vector<Loop>& loops, Inside inside) {
  const std::size_t count = loops.size();
  std::vector<double> area(count);
  std::vector<LoopBox> box(count);
  for (std::size_t k = 0; k < count; ++k) area[k] = twice_area(points, loops[k]), box[k] = box_of(points, loops[k]);
  std::vector<std::size_t> by_size(count);  // the loops around a loop are before it
  std::iota(by_size.begin(), by_size.end(), std::size_t(0));
  std::stable_sort(by_size.begin(), by_size.end(),
                   [&](std::size_t a, std::size_t b) { return std::abs(area[a]) > std::abs(area[b]); });
  std::vector<Region> regions;
  std::vector<std::size_t> outer_of;  // the loop of each region
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = by_size[i];
    if (area[k] == 0.0) continue;
    int around = 0;
    std::vector<char> contains(count, 0);
    for (std::size_t j = 0; j < i; ++j) {
      const std::size_t other = by_size[j];
      if (area[other] == 0.0 || !box[other].contains(box[k]) || !is_loop_inside(points, loops[other], loops[k]))
        continue;
      contains[other] = 1;
      around += inside == Inside::kOdd || area[other] > 0.0 ? 1 : -1;
    }
    const int within = around + (inside == Inside::kOdd || area[k] > 0.0 ? 1 : -1);
    const auto filled = [&](int winding) { return inside == Inside::kOdd ? winding % 2 != 0 : winding != 0; };
    if (filled(around) == filled(within)) continue;
    Loop loop = loops[k];
    set_direction(points, filled(within), loop);
    if (filled(within)) {
      regions.push_back({std::move(loop), {}});
      outer_of.push_back(k);
      continue;
    }
    for (std::size_t r = regions.size(); r-- > 0;)  // the smallest one is last
      if (contains[outer_of[r]]) {
        regions[r].holes.push_back(std::move(loop));
        break;
      }
  }
  return regions;
}

/// A polygon from which ears are cut, as a ring of nodes.
class Ring {
 public:
  Ring(PlanePoints points, const Region& region) : points_(points) {
    start_ = add_loop(region.outer);
    std::vector<int> holes;
    for (const Loop& hole : region.holes) {
      const int first = add_loop(hole);
      int leftmost = first;
      for (int k = next(first); k != first; k = next(k))
        if (std::pair(at(k).x, at(k).y) < std::pair(at(leftmost).x, at(leftmost).y)) leftmost = k;
      holes.push_back(leftmost);
    }
    std::sort(holes.begin(), holes.end(),
              [&](int a, int b) { return std::pair(at(a).x, at(a).y) < std::pair(at(b).x, at(b).y); });
    for (const int hole : holes)
      if (const int bridge = bridge_from(hole); bridge >= 0) join(bridge, hole);
  }

  /// Cuts all ears and appends them.
  void cut(std::vector<CornerTriple>& triangles) {
    int ear = start_, unsuccessful = 0;
    while (count_ > 2) {
      if (unsuccessful > count_) ear = node_without_ears();
      if (unsuccessful > count_ || is_ear(ear)) {
        if (!returns(ear))
          triangles.push_back({nodes_[std::size_t(before(ear))].point, nodes_[std::size_t(ear)].point,
                               nodes_[std::size_t(next(ear))].point});
        const int after = next(ear);
        remove(ear);
        unsuccessful = 0;
        ear = next(after);  // so that triangles do not form a fan
        continue;
      }
      ear = next(ear);
      ++unsuccessful;
    }
  }

 private:
  struct Node {
    std::uint32_t point;
    int before, next;
  };

  const glm::dvec2& at(int node) const { return points_[nodes_[std::size_t(node)].point]; }
  int next(int node) const { return nodes_[std::size_t(node)].next; }
  int before(int node) const { return nodes_[std::size_t(node)].before; }
  double corner(int node) const { return cross_of(at(before(node)), at(node), at(next(node))); }

  bool returns(int node) const {
    return at(node) == at(next(node)) || at(node) == at(before(node)) || at(before(node)) == at(next(node));
  }

  /// Returns the node to remove from a ring without ears: one on an edge that returns on itself; else loops cross, or
  /// touch but for rounding, and it is the one with the smallest triangle.
  int node_without_ears() const {
    int best = start_, k = start_;
    do {
      if (returns(k)) return k;
      if (std::abs(corner(k)) < std::abs(corner(best))) best = k;
      k = next(k);
    } while (k != start_);
    return best;
  }

  int add_loop(const Loop& loop) {
    const int first = int(nodes_.size()), size = int(loop.size());
    for (int k = 0; k < size; ++k)
      nodes_.push_back({loop[std::size_t(k)], first + (k + size - 1) % size, first + (k + 1) % size});
    count_ += size;
    return first;
  }

  void remove(int node) {
    nodes_[std::size_t(before(node))].next = next(node);
    nodes_[std::size_t(next(node))].before = before(node);
    start_ = next(node);
    --count_;
  }

  /// Joins a hole to the ring by an edge from a node to a node of the hole and one back, or where they touch.
  void join(int node, int hole) {
    if (at(node) == at(hole)) {
      const int copy = int(nodes_.size()), first = next(hole), last = before(hole), after = next(node);
      nodes_.push_back({nodes_[std::size_t(hole)].point, last, after});
      nodes_[std::size_t(after)].before = copy;
      nodes_[std::size_t(last)].next = copy;
      nodes_[std::size_t(node)].next = first;
      nodes_[std::size_t(first)].before = node;
      return;
    }
    const int node_copy = int(nodes_.size()), hole_copy = node_copy + 1;
    const int after = next(node), last = before(hole);
    nodes_.push_back({nodes_[std::size_t(node)].point, hole_copy, after});
    nodes_.push_back({nodes_[std::size_t(hole)].point, last, node_copy});
    nodes_[std::size_t(after)].before = node_copy;
    nodes_[std::size_t(last)].next = hole_copy;
    nodes_[std::size_t(node)].next = hole;
    nodes_[std::size_t(hole)].before = node;
    count_ += 2;
  }

  /// Returns whether a node, as part of the ring's border, sees a point in its interior angle.
  bool opens_to(int node, const glm::dvec2& p) const {
    const bool left_of_first = cross_of(at(before(node)), at(node), p) > 0.0,
               left_of_second = cross_of(at(node), at(next(node)), p) > 0.0;
    return corner(node) >= 0.0 ? left_of_first && left_of_second : left_of_first || left_of_second;
  }

  /// Returns the node of the ring that a bridge can join to the leftmost node of a hole; below 0: none.
  int bridge_from(int hole) const {
    const glm::dvec2 h = at(hole);
    double x = std::numeric_limits<double>::lowest();
    int best = -1, k = start_;
    // The nearest edge to the left of the hole; its end that is farther to the left may be visible.
    do {
      const glm::dvec2 &a = at(k), &b = at(next(k));
      if (a == h && opens_to(k, at(next(hole)))) return k;
      if (a.y >= h.y && b.y <= h.y && a.y != b.y) {
        const double crossing = a.x + (b.x - a.x) * ((h.y - a.y) / (b.y - a.y));
        if (crossing <= h.x && crossing > x) {
          x = crossing;
          best = a.x < b.x ? k : next(k);
        }
      }
      k = next(k);
    } while (k != start_);
    if (best < 0) return best;
    // Nodes in the triangle of the hole, the edge and its end hide this end: the one at the smallest angle is visible.
    const glm::dvec2 on_edge(x, h.y), end = at(best);
    double smallest = std::numeric_limits<double>::max();
    const int first = best;
    k = first;
    do {
      const glm::dvec2& p = at(k);
      const bool above = end.y > h.y;
      const glm::dvec2 &a = above ? on_edge : h, &b = above ? h : on_edge;
      if (p.x <= h.x && p.x >= end.x && p != h && cross_of(a, b, p) >= 0.0 && cross_of(b, end, p) >= 0.0 &&
          cross_of(end, a, p) >= 0.0 && opens_to(k, h)) {
        const double angle = std::abs(p.y - h.y) / (h.x - p.x);
        if (angle < smallest || (angle == smallest && p.x > at(best).x)) best = k, smallest = angle;
      }
      k = next(k);
    } while (k != first);
    return best;
  }

  bool is_ear(int ear) const {
    const glm::dvec2 &a = at(before(ear)), &b = at(ear), &c = at(next(ear));
    if (!(cross_of(a, b, c) > 0.0)) return false;
    const double left = std::min({a.x, b.x, c.x}), right = std::max({a.x, b.x, c.x}), low = std::min({a.y, b.y, c.y}),
                 high = std::max({a.y, b.y, c.y});
    for (int k = next(next(ear)); k != before(ear); k = next(k)) {
      const glm::dvec2& p = at(k);
      if (p.x < left || p.x > right || p.y < low || p.y > high || p == a || p == b || p == c) continue;
      if (cross_of(a, b, p) >= 0.0 && cross_of(b, c, p) >= 0.0 && cross_of(c, a, p) >= 0.0) return false;
    }
    return true;
  }

  PlanePoints points_;
  std::vector<Node> nodes_;
  int start_ = 0, count_ = 0;
};

}  // namespace

double twice_area(std::span<const glm::dvec2> points, const Loop& loop) {
  double area = 0.0;
  for (std::size_t k = 1; k + 1 < loop.size(); ++k)
    area += cross_of(points[loop[0]], points[loop[k]], points[loop[k + 1]]);
  return area;
}

std::vector<CornerTriple> triangulate(std::span<const glm::dvec2> points, const std::vector<Loop>& loops,
                                      Inside inside) {
  std::vector<CornerTriple> triangles;
  for (const Region& region : regions_of(points, loops, inside)) Ring(points, region).cut(triangles);
  return triangles;
}

}  // namespace umbrage
