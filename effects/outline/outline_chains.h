// Chains: lines of an outline while they are traced. Lengths in pixels are for a picture 1024 pixels high and grow with
// it, but for those that are of the pixels' grid.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/lines.h"
#include "effects/outline/outline.h"
#include "effects/outline/outline_graph.h"
#include "kernel/host_frame.h"

namespace umbrage {

constexpr float kStraightOn = 0.64f;  // cosine: two ends that meet at less than 50 degrees are one line

struct ChainPoint {
  float x = 0.0f, y = 0.0f;
  float strength = 0.0f;  // in units of the edge's threshold
  float depth = 0.0f;     // of the nearer surface
  float drop = 0.0f;      // how far the other one lies behind it, pixel sizes; infinite if it is another object
  int object = 0;         // of the nearer surface
  int edge = -1;          // by which other chains' ends refer to it; -1: bridges a gap
  int node = -1;          // junction between it and the next point, or -1
  std::uint8_t kind = 0;  // of the edge
};

struct Chain {
  std::vector<ChainPoint> points;
  std::array<int, 2> node = {-1, -1};    // that its ends lie at, or -1
  std::array<int, 2> joined = {-1, -1};  // edges of other chains, beside which its ends go on, or -1
  bool closed = false;
  float weight = 1.0f;  // share of its width: less where it hardly stays

  const ChainPoint& end(int last) const { return last ? points.back() : points.front(); }
};

using Direction = std::array<float, 2>;  // of length 1

/// What is known of a picture's chains.
struct Tracing {
  Tracing(const HostFrame& frame, const OutlineConstants& constants);

  const HostFrame& frame;
  const OutlineConstants& c;
  const HostPlane &depth, &object;
  EdgeGraph graph;
  std::vector<Chain> chains;

  /// Size of a pixel at a depth, in units of depth.
  float pixel(float depth) const {
    return frame.frame.orthographic != 0 ? frame.frame.ray_scale_x : frame.frame.ray_scale_x * depth;
  }
  /// How many chains meet at each node: one that ends there once, one that passes twice.
  std::vector<int> meetings() const;
  /// Whether a chain's end leads to nothing.
  bool is_free(const Chain& chain, int last, const std::vector<int>& meetings) const;
  /// Forgets chains without points, and what was joined to them.
  void drop_empty();
};

inline float length_of(float x, float y) { return std::sqrt(x * x + y * y); }
/// The way along a chain at a point, over a few points to either side.
Direction way_at(const Chain& chain, int point);
/// Where a chain leads at an end, outwards.
Direction lead(const Chain& chain, int last);

/// The steps of tracing, in their order.
void find_chains(Tracing& t);       ///< from the graph's edges; those that go on in each other are one
void keep_clear_parts(Tracing& t);  ///< hysteresis: whole parts stay or go
void bridge_gaps(Tracing& t);       ///< joins ends that face each other, or that face a side
void drop_short(Tracing& t, float free_px, float branch_px);  ///< what is shorter, and free at both ends or at one
void smooth_chains(Tracing& t);
void meet(Tracing& t);  ///< leads ends to what they meet, and closes what is closed

/// Links chains by their ends (2 * chain + last): `mate` has for each end the one that it goes on in, or -1. Over gaps
/// points are added.
void concatenate(Tracing& t, const std::vector<int>& mate, bool over_gaps);

}  // namespace umbrage
