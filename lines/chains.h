// Chains: polylines along the edges of a graph, while they are traced. Places and lengths are in pixels of the graph's
// picture, from its upper left corner: the first pixel's centre lies at (0.5, 0.5).
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "lines/graph.h"

namespace umbrage {

constexpr float kStraightOn = 0.64f;  // cosine: two ends that meet at less than 50 degrees are one line

struct ChainPoint {
  float x = 0.0f, y = 0.0f;
  float strength = 0.0f;  // of the edge
  int edge = -1;          // by which other chains' ends refer to it; -1: bridges a gap
  int node = -1;          // junction between it and the next point, or -1
  std::uint8_t kind = 0;  // of the edge
  // What lies at the edge, which the caller fills in where it knows:
  float depth = 0.0f;  // of the nearer surface
  float drop = 0.0f;   // how far the other one lies behind it, in the caller's unit
  int object = 0;      // number of what the nearer surface belongs to
};

/// A chain that is not closed has two ends, 0 the first and 1 the last; of all chains they are numbered 2 * chain +
/// end.
struct Chain {
  std::vector<ChainPoint> points;        // at least one
  std::array<int, 2> node = {-1, -1};    // that its ends lie at, or -1
  std::array<int, 2> joined = {-1, -1};  // edges of other chains, beside which its ends go on, or -1
  bool closed = false;
  float weight = 1.0f;  // 0 to 1: less where it was hardly kept

  const ChainPoint& end(int last) const { return last ? points.back() : points.front(); }
};

/// A picture's chains, and the graph whose edges and nodes they name.
struct Tracing {
  EdgeGraph graph;
  std::vector<Chain> chains = {};

  /// Of each end whether it leads to nothing: no other chain, no border of the picture. A closed chain has no free end.
  std::vector<std::uint8_t> free_ends() const;
};

using Direction = std::array<float, 2>;  // of length 1

inline float length_of(float x, float y) { return std::sqrt(x * x + y * y); }
/// Of a chain, with about a third of a pixel beyond each end.
float length_of(const Chain& chain);
/// The way along a chain at a point, over a few points to either side.
Direction way_at(const Chain& chain, int point);
/// Where a chain leads at an end, outwards.
Direction lead(const Chain& chain, int last);

/// Makes one chain of those that go on in each other: `mate` has for each end the one that it goes on in, or -1. Over
/// gaps points are added, a pixel apart: their depth goes over evenly, strength and drop are the lesser of both ends',
/// kind and object the first's.
void concatenate(Tracing& t, const std::vector<int>& mate, bool over_gaps);

}  // namespace umbrage
