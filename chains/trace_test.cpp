// Tests line tracing on small pictures with known edges.
#include <algorithm>

#include "chains/trace.h"

#include "core/check.h"

namespace umbrage {
namespace {

Edge right_of(int x, int y, int kind = 1, float strength = 2.0f) {
  return {.x = x, .y = y, .kind = std::uint8_t(kind), .step_kind = 1, .strength = strength};
}

Edge below(int x, int y, int kind = 1, float strength = 2.0f) {
  Edge e = right_of(x, y, kind, strength);
  e.below = true;
  return e;
}

/// Returns the edges between pixels of a bitmap that differ.
std::vector<Edge> edges_of(int width, int height, const std::function<bool(int, int)>& bitmap) {
  std::vector<Edge> edges;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (x + 1 < width && bitmap(x, y) != bitmap(x + 1, y)) edges.push_back(right_of(x, y));
      if (y + 1 < height && bitmap(x, y) != bitmap(x, y + 1)) edges.push_back(below(x, y));
    }
  return edges;
}

/// Returns the tracing of a picture of 64 x 64 pixels after its chains have been found and joined at junctions.
Tracing joined(std::vector<Edge> edges) {
  Tracing t{EdgeGraph(std::move(edges), 64, 64)};
  find_chains(t);
  join_at_junctions(t);
  return t;
}

/// Returns `count` edges between rows y and y + 1, from column x on.
std::vector<Edge> row(int x, int y, int count, int kind = 1) {
  std::vector<Edge> edges;
  for (int k = 0; k < count; ++k) edges.push_back(below(x + k, y, kind));
  return edges;
}

/// Returns `count` edges between columns x and x + 1, from row y on.
std::vector<Edge> column(int x, int y, int count, int kind = 1) {
  std::vector<Edge> edges;
  for (int k = 0; k < count; ++k) edges.push_back(right_of(x, y + k, kind));
  return edges;
}

std::vector<Edge> together(std::vector<std::vector<Edge>> parts) {
  std::vector<Edge> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

int count_free(const Tracing& t) {
  const std::vector<std::uint8_t> free = t.free_ends();
  return int(std::count(free.begin(), free.end(), 1));
}

TEST(LineTracing, ABitmapHasTheBoundariesOfItsParts) {
  const std::vector<std::string> bitmap = {"........",  //
                                           ".##.....",  //
                                           ".##..#..",  //
                                           "........"};
  Tracing t{EdgeGraph(edges_of(8, 4, [&](int x, int y) { return bitmap[y][x] == '#'; }), 8, 4)};
  EXPECT_EQ(t.graph.size(), 12);
  find_chains(t);
  ASSERT_EQ(t.chains.size(), 2u);
  EXPECT_TRUE(t.chains[0].closed && t.chains[1].closed);
  EXPECT_EQ(t.chains[0].points.size(), 8u);
  std::vector<std::array<float, 2>> places;
  for (const ChainPoint& p : t.chains[1].points) places.push_back({p.x, p.y});
  std::sort(places.begin(), places.end());
  EXPECT_EQ(places, (std::vector<std::array<float, 2>>{{5.0f, 2.5f}, {5.5f, 2.0f}, {5.5f, 3.0f}, {6.0f, 2.5f}}));
  EXPECT_EQ(count_free(t), 0);
}

TEST(LineTracing, EdgesLieInsideThePictureAndHaveAKind) {
  EXPECT_THROW(EdgeGraph({right_of(3, 0)}, 4, 4), InternalError);
  EXPECT_THROW(EdgeGraph({below(0, 3)}, 4, 4), InternalError);
  EXPECT_THROW(EdgeGraph({below(0, -1)}, 4, 4), InternalError);
  EXPECT_THROW(EdgeGraph({below(0, 0, 0)}, 4, 4), InternalError);
}

TEST(LineTracing, TheMoreReliableOfTwoEdgesOnOneSideIsKept) {
  const EdgeGraph graph({below(1, 1, 1, 3.0f), below(1, 1, 2, 1.0f), below(2, 2, 1, 1.0f), below(2, 2, 1, 2.0f)}, 8, 8);
  ASSERT_EQ(graph.size(), 3);  // including the edge added between the two
  EXPECT_EQ(graph[0].kind, 2);
  EXPECT_EQ(graph[2].strength, 2.0f);
}

TEST(LineTracing, StepsAreClosed) {
  const Tracing t = joined(together({row(0, 10, 10, 2), row(10, 11, 10, 2)}));
  ASSERT_EQ(t.chains.size(), 1u);
  ASSERT_EQ(t.chains[0].points.size(), 21u);
  EXPECT_EQ(t.chains[0].points[10].kind, 1);
  EXPECT_EQ(t.chains[0].points[10].x, 10.0f);
}

TEST(LineTracing, JunctionsJoinStraightContinuations) {
  Tracing t = joined(together({column(15, 0, 64), row(16, 15, 30)}));
  ASSERT_EQ(t.chains.size(), 2u);
  const int branch = t.chains[0].points.size() == 30 ? 0 : 1;
  EXPECT_EQ(t.chains[1 - branch].points.size(), 64u);
  EXPECT_EQ(count_free(t), 1);
  smooth_chains(t);
  connect_ends(t);
  const ChainPoint& end = t.chains[branch].end(t.chains[branch].end(0).x < t.chains[branch].end(1).x ? 0 : 1);
  EXPECT_NEAR(end.x, 16.0f, 0.01f);
  EXPECT_NEAR(end.y, 16.0f, 0.01f);
}

TEST(LineTracing, JunctionsJoinTheTwoMostReliable) {
  const Tracing t = joined(together({column(15, 0, 16, 2), column(15, 16, 48, 1), row(16, 15, 48, 2)}));
  ASSERT_EQ(t.chains.size(), 2u);
  const Chain &first = t.chains[0], &second = t.chains[1];
  EXPECT_EQ(std::max(first.points.size(), second.points.size()), 64u);
  EXPECT_EQ(count_free(t), 0);
  // The two of kind 2 are joined, although they meet at a right angle and another continues one of them.
  for (const ChainPoint& p : (first.points.size() > second.points.size() ? first : second).points)
    EXPECT_EQ(p.kind, 2) << p.x << ", " << p.y;
}

TEST(LineTracing, GapsAreBridgedWithinReach) {
  for (const bool wide : {false, true}) {
    Tracing t = joined(together({row(5, 20, 16), row(31, 20, 16)}));
    bridge_gaps(t, wide ? 16.0f : 8.0f, {});
    ASSERT_EQ(t.chains.size(), wide ? 1u : 2u);
    if (wide) {
      EXPECT_NEAR(length_of(t.chains[0]), 42.0f, 1.0f);
    }
  }
  Tracing apart = joined(together({row(5, 20, 16), row(31, 20, 16)}));
  for (ChainPoint& p : apart.chains[1].points) p.depth = 1000.0f;  // behind, in pixel sizes
  bridge_gaps(apart, 16.0f, {});
  EXPECT_EQ(apart.chains.size(), 2u);
}

TEST(LineTracing, EndsAreJoinedToTheSideThatTheyFace) {
  Tracing t = joined(together({column(31, 0, 64), row(0, 20, 28)}));
  EXPECT_EQ(count_free(t), 1);
  bridge_gaps(t, 16.0f, {});
  EXPECT_EQ(count_free(t), 0);
  smooth_chains(t);
  connect_ends(t);
  float max = 0.0f;
  for (const Chain& chain : t.chains)
    if (chain.joined[0] >= 0 || chain.joined[1] >= 0)
      for (const ChainPoint& p : chain.points) max = std::max(max, p.x);
  EXPECT_NEAR(max, 32.0f, 0.01f);
}

// A short bar is dropped, and then the branch that ended at it.
TEST(LineTracing, ShortChainsAreDroppedAndThenThoseTheyLeaveFree) {
  const auto min = [](const Chain&, int free_ends) { return free_ends == 2 ? 24.0f : 6.0f; };
  Tracing t = joined(together({column(20, 20, 12), row(21, 25, 10), row(5, 50, 30), row(30, 5, 24)}));
  ASSERT_EQ(t.chains.size(), 4u);
  drop_short(t, [](const Chain&, int) { return 0.0f; });
  ASSERT_EQ(t.chains.size(), 4u);
  drop_short(t, min);
  ASSERT_EQ(t.chains.size(), 1u);
  EXPECT_EQ(t.chains[0].points.size(), 30u);
  EXPECT_NEAR(t.chains[0].weight, 2.0f * (29.7f / 24.0f - 1.0f), 1e-4f);
}

// A square with two tails. Part of its left side is faint: the square is open there, and has no other new ends.
TEST(LineTracing, ClosedChainsAreCutWhereTheyAreFaint) {
  constexpr int kLow = 60, kHigh = 180;
  std::vector<Edge> edges;
  for (int k = kLow; k < kHigh; ++k) {
    edges.push_back(below(k, kLow));
    edges.push_back(below(k, kHigh));
    edges.push_back(right_of(kLow - 1, k + 1, 1, k > 100 && k < 140 ? 0.5f : 2.0f));
    edges.push_back(right_of(kHigh - 1, k + 1));
  }
  for (int k = kHigh; k < kHigh + 50; ++k) {
    edges.push_back(below(k, 100));
    edges.push_back(below(k, 150));
  }
  Tracing t{EdgeGraph(edges, 256, 256)};
  find_chains(t);
  join_at_junctions(t);
  EXPECT_EQ(count_free(t), 2);
  keep_clear_parts(t, {.faint = 0.6f, .clear = 0.8f, .full = 0.97f, .around = 1});
  EXPECT_EQ(count_free(t), 4);
  smooth_chains(t);
  connect_ends(t);
  float sum = 0.0f;
  for (const Chain& chain : t.chains) sum += length_of(chain);
  EXPECT_NEAR(sum, 4 * (kHigh - kLow) - 40 + 100, 6.0);
}

TEST(LineTracing, BarelyClearChainsWeighLess) {
  for (const float strength : {0.75f, 0.85f, 2.0f}) {
    std::vector<Edge> edges;
    for (int k = 0; k < 30; ++k) edges.push_back(below(k, 20, 1, strength));
    Tracing t = joined(edges);
    keep_clear_parts(t, {.faint = 0.6f, .clear = 0.8f, .full = 1.0f, .around = 4});
    ASSERT_EQ(t.chains.size(), strength > 0.8f ? 1u : 0u);
    if (!t.chains.empty()) {
      EXPECT_NEAR(t.chains[0].weight, strength > 1.0f ? 1.0f : 0.25f, 1e-4f);
    }
  }
}

TEST(LineTracing, SmoothChainsAreStraightAndRound) {
  Tracing straight = joined(edges_of(64, 64, [](int x, int y) { return 0.37 * (x + 0.5) + 10.0 < y + 0.5; }));
  ASSERT_EQ(straight.chains.size(), 1u);
  smooth_chains(straight);
  for (const ChainPoint& p : straight.chains[0].points) EXPECT_NEAR(p.y, 0.37f * p.x + 10.0f, 0.35f) << p.x;
  Tracing round = joined(edges_of(64, 64, [](int x, int y) { return std::hypot(x - 31.6, y - 30.9) < 24.0; }));
  ASSERT_EQ(round.chains.size(), 1u);
  EXPECT_TRUE(round.chains[0].closed);
  smooth_chains(round);
  for (const ChainPoint& p : round.chains[0].points) EXPECT_NEAR(std::hypot(p.x - 32.1, p.y - 31.4), 24.0, 0.35);
}

TEST(LineTracing, SimplifiedLinesKeepTheirCorners) {
  std::vector<StrokePoint> corner;
  for (int k = 0; k <= 20; ++k) corner.push_back({float(std::min(k, 10)), float(std::max(k - 10, 0)), 2.0f});
  const std::vector<StrokePoint> kept = simplified(corner);
  EXPECT_LT(kept.size(), 8u);
  EXPECT_TRUE(std::any_of(kept.begin(), kept.end(), [](const StrokePoint& p) { return p.x == 10.0f && p.y == 0.0f; }));
  EXPECT_EQ(kept.back().y, 10.0f);
}

TEST(LineTracing, SimplifiedLinesAreCloseToAllPoints) {
  // An arc whose width changes, and is too wide at one point. Of a chord of n points the arc is off by n^2 / (8
  // radius).
  constexpr float kRadius = 40.0f;
  constexpr int kCount = 60;
  std::vector<StrokePoint> arc;
  for (int k = 0; k < kCount; ++k) {
    const float angle = float(k) / kRadius;
    arc.push_back({kRadius * std::sin(angle), kRadius * std::cos(angle), k == 35 ? 3.0f : 2.0f});
  }
  const std::vector<StrokePoint> kept = simplified(arc);
  EXPECT_LT(kept.size(), std::size_t(kCount / 2));
  EXPECT_EQ(kept.front().x, arc.front().x);
  EXPECT_EQ(kept.back().x, arc.back().x);
  std::size_t segment = 0;
  for (const StrokePoint& p : arc) {
    while (kept[segment + 1].x < p.x) ++segment;
    const StrokePoint &a = kept[segment], &b = kept[segment + 1];
    const float dx = b.x - a.x, dy = b.y - a.y;
    EXPECT_LT(std::abs((p.y - a.y) * dx - (p.x - a.x) * dy) / std::hypot(dx, dy), 0.0501f) << p.x;
    const float along = ((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy);
    EXPECT_LT(std::abs(a.width + along * (b.width - a.width) - p.width), 0.11f) << p.x;
  }
}

}  // namespace
}  // namespace umbrage
