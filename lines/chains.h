// Chains: polylines along the edges of a graph, during tracing. Positions and lengths are in pixels of the graph's
// picture, from its upper left corner: the first pixel's centre is at (0.5, 0.5).
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "lines/graph.h"

namespace umbrage {

constexpr float kMinStraightCosine = 0.64f;  // cosine: two ends that meet at less than 50 degrees continue each other

struct ChainPoint {
  float x = 0.0f, y = 0.0f;
  float strength = 0.0f;  // of the edge
  int edge = -1;          // the edge, to which other chains' ends refer; -1: the point bridges a gap
  int node = -1;          // junction between it and the next point, or -1
  std::uint8_t kind = 0;  // of the edge
  // The surfaces at the edge, filled in by the caller where known:
  float depth = 0.0f;  // of the nearer surface
  float drop = 0.0f;   // depth of the other surface behind the nearer one, in the caller's unit
  int object = 0;      // number of the nearer surface's object
};

/// A chain. If it is not closed it has two ends, 0 the first and 1 the last; among all chains ends have the number
/// 2 * chain + end.
struct Chain {
  std::vector<ChainPoint> points;        // at least one
  std::array<int, 2> node = {-1, -1};    // junctions at its ends, or -1
  std::array<int, 2> joined = {-1, -1};  // edges of other chains that its ends continue to, or -1
  bool closed = false;
  float weight = 1.0f;  // 0 to 1: smaller if it was barely kept

  const ChainPoint& end(int last) const { return last ? points.back() : points.front(); }
};

/// The chains of a picture, and the graph to whose edges and nodes they refer.
struct Tracing {
  EdgeGraph graph;
  std::vector<Chain> chains = {};

  /// Returns for each end whether it is free: it meets no other chain and no border of the picture. A closed chain has
  /// no free end.
  std::vector<std::uint8_t> free_ends() const;
};

using Direction = std::array<float, 2>;  // unit length

inline float length_of(float x, float y) { return std::sqrt(x * x + y * y); }
/// Returns the length of a chain, including about a third of a pixel beyond each end.
float length_of(const Chain& chain);
/// Returns the direction along a chain at a point, over a few points to either side.
Direction chain_direction_at(const Chain& chain, int point);
/// Returns the outward direction of a chain at an end.
Direction lead(const Chain& chain, int last);

/// Concatenates chains that continue each other: `mate` has for each end the end that continues it, or -1. If
/// `over_gaps`, points are added a pixel apart in the gaps: depth is interpolated linearly, strength and drop are the
/// minimum of both ends', kind and object are the first's.
void concatenate(Tracing& t, const std::vector<int>& mate, bool over_gaps);

}  // namespace umbrage
