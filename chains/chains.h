// Chains: the polylines along the edges of a graph that tracing works on. Positions and lengths are in pixels of the
// graph's picture, from its upper left corner: the first pixel's centre is at (0.5, 0.5).
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "chains/graph.h"

namespace umbrage {

constexpr float kMinStraightCosine = 0.64f;  // of 50 degrees, the max turn at which one end continues another

struct ChainPoint {
  float x = 0.0f, y = 0.0f;
  float strength = 0.0f;  // of the edge
  int edge = -1;          // the edge, which Chain::joined of other chains may name; -1: the point bridges a gap
  int node = -1;          // junction between this point and the next, or -1
  std::uint8_t kind = 0;  // of the edge
  // The surfaces at the edge. The caller fills these in if it knows them.
  float depth = 0.0f;  // of the nearer surface
  float drop = 0.0f;   // depth of the other surface behind the nearer one, in the caller's unit
  int object = 0;      // number of the nearer surface's object
};

/// A chain. Unless it is closed it has two ends: 0, its first point, and 1, its last. Among all chains, an end has the
/// number 2 * chain + end.
struct Chain {
  std::vector<ChainPoint> points;        // at least one
  std::array<int, 2> node = {-1, -1};    // per end: the junction there, or -1
  std::array<int, 2> joined = {-1, -1};  // per end: the edge of another chain that the end is extended to, or -1
  bool closed = false;
  float weight = 1.0f;  // 0 to 1; below 1 if the chain only just met a limit

  const ChainPoint& end(int last) const { return last ? points.back() : points.front(); }
};

/// The chains of a picture, and the graph whose edges and nodes they refer to.
struct Tracing {
  EdgeGraph graph;
  std::vector<Chain> chains = {};

  /// Returns one flag per end: whether it is free, that is, meets neither another chain nor the picture's border.
  /// Closed chains have no free end.
  std::vector<std::uint8_t> free_ends() const;
};

using Direction = std::array<float, 2>;  // a unit vector

inline float length_of(float x, float y) { return std::sqrt(x * x + y * y); }
/// Returns the length of a chain, plus about a third of a pixel for each end.
float length_of(const Chain& chain);
/// Returns the distance of each point along a polyline from its first.
template <class Point>
std::vector<float> distances_along(const std::vector<Point>& points) {
  std::vector<float> along = {0.0f};
  for (std::size_t k = 1; k < points.size(); ++k)
    along.push_back(along.back() + length_of(points[k].x - points[k - 1].x, points[k].y - points[k - 1].y));
  return along;
}
/// Returns the direction of a chain at a point, estimated from a few points on either side.
Direction chain_direction_at(const Chain& chain, int point);
/// Returns the direction in which a chain would continue beyond an end.
Direction end_direction(const Chain& chain, int last);

/// Concatenates chains that continue each other. `mate` gives, for each end, the end that continues it, or -1. If
/// `over_gaps`, the gaps are filled with points a pixel apart: their depth is interpolated linearly, strength and drop
/// are the smaller of the two ends' values, kind and object are those of the first end.
void concatenate(Tracing& t, const std::vector<int>& mate, bool over_gaps);

}  // namespace umbrage
