// Implements find_chains and join_at_junctions.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>

#include "chains/trace.h"

namespace umbrage {
namespace {

/// Sets the position, strength and kind of a point from its edge.
void set_from_edge(const Edge& e, ChainPoint& p) {
  p.x = float(e.x) + 0.5f, p.y = float(e.y) + 0.5f;
  (e.below ? p.y : p.x) += e.place;
  p.strength = e.strength, p.kind = e.kind;
}

/// Returns the outward direction of a chain at an end that is at a node. For a chain of few points this is the
/// direction from the node at its other end.
Direction end_direction_at_node(const Tracing& t, int end) {
  constexpr int kFew = 3;
  const Chain& chain = t.chains[end / 2];
  if (int(chain.points.size()) >= kFew) return end_direction(chain, end % 2);
  const auto here = EdgeGraph::position(t.graph.node(chain.node[end % 2]));
  const auto there = EdgeGraph::position(t.graph.node(chain.node[1 - end % 2]));
  const float dx = here[0] - there[0], dy = here[1] - there[1], length = std::max(length_of(dx, dy), 1.0f);
  return {dx / length, dy / length};
}

/// Pairs the ends at one node that continue each other and records the pairs in `mate`. If exactly two ends have the
/// highest kind, they are paired first; otherwise the straightest and most similar pair comes first.
void pair_node(const Tracing& t, std::span<const int> ends, const std::vector<float>& strength,
               std::vector<int>& mate) {
  const auto kind = [&](std::size_t k) { return t.chains[ends[k] / 2].end(ends[k] % 2).kind; };
  int max_kind = 0, count = 0;
  std::array<Direction, EdgeGraph::kWays> directions;
  for (std::size_t k = 0; k < ends.size(); ++k) {
    if (kind(k) > max_kind) count = 0;
    max_kind = std::max(max_kind, int(kind(k)));
    count += kind(k) == max_kind;
    directions[k] = end_direction_at_node(t, ends[k]);
  }
  std::array<std::tuple<float, int, int>, EdgeGraph::kWays*(EdgeGraph::kWays - 1) / 2> pairs;
  std::size_t found = 0;
  for (std::size_t a = 0; a < ends.size(); ++a)
    for (std::size_t b = a + 1; b < ends.size(); ++b) {
      const int chain_a = ends[a] / 2, chain_b = ends[b] / 2;
      if (chain_a == chain_b) continue;
      const float cosine = -(directions[a][0] * directions[b][0] + directions[a][1] * directions[b][1]);
      const bool both_max_kind = count == 2 && kind(a) == max_kind && kind(b) == max_kind;
      if (cosine < kMinStraightCosine && !both_max_kind) continue;
      const float sa = strength[chain_a], sb = strength[chain_b];
      const float similarity = (kind(a) == kind(b) ? 1.0f : 0.9f) * std::sqrt(2.0f * std::min(sa, sb) / (sa + sb));
      pairs[found++] = {both_max_kind ? -2.0f : -cosine * similarity, ends[a], ends[b]};
    }
  for (int pair = 0; pair < EdgeGraph::kWays / 2; ++pair) {
    const std::tuple<float, int, int>* best = nullptr;
    for (const auto& each : std::span(pairs).first(found))
      if (mate[std::get<1>(each)] < 0 && mate[std::get<2>(each)] < 0 && (!best || each < *best)) best = &each;
    if (!best) return;
    mate[std::get<1>(*best)] = std::get<2>(*best);
    mate[std::get<2>(*best)] = std::get<1>(*best);
  }
}

}  // namespace

void find_chains(Tracing& t) {
  const EdgeGraph& graph = t.graph;
  std::vector<std::uint8_t> visited(std::size_t(graph.size()), 0);
  const auto walk = [&](EdgeGraph::Node node, int way, bool closed) {
    Chain& chain = t.chains.emplace_back();
    chain.closed = closed;
    if (!closed) chain.node[0] = graph.number_of(node);
    for (;;) {
      const int edge = graph.edge(node, way);
      if (visited[edge]) return;  // the chain is closed
      visited[edge] = 1;
      chain.points.push_back({.edge = edge});
      node = EdgeGraph::next(node, way);
      const unsigned onward = graph.ways(node) & ~(1u << EdgeGraph::opposite(way));
      if (!std::has_single_bit(onward)) break;
      way = std::countr_zero(onward);
    }
    chain.node[1] = graph.number_of(node);
  };
  for (const bool closed : {false, true})  // edges that remain after the first round form closed chains
    for (int edge = 0; edge < graph.size(); ++edge) {
      if (visited[edge]) continue;
      const int way = graph[edge].below ? 1 : 2;  // from the edge's first node to its last
      if (closed || graph.degree(graph.first_node(edge)) != 2)
        walk(graph.first_node(edge), way, closed);
      else if (graph.degree(graph.last_node(edge)) != 2)
        walk(graph.last_node(edge), EdgeGraph::opposite(way), closed);
    }
  tbb::parallel_for(std::size_t(0), t.chains.size(), [&](std::size_t k) {
    for (ChainPoint& p : t.chains[k].points) set_from_edge(graph[p.edge], p);
  });
}

void join_at_junctions(Tracing& t) {
  // `ends` holds the ends sorted by node; first[node] is the index of a node's first entry.
  std::vector<int> first(2 * std::size_t(t.graph.size()) + 1, 0), ends;
  const auto for_ends = [&](const auto& work) {
    for (int end = 0; end < 2 * int(t.chains.size()); ++end)
      if (const int node = t.chains[end / 2].node[end % 2]; node >= 0) work(end, std::size_t(node));
  };
  for_ends([&](int, std::size_t node) { ++first[node + 1]; });
  for (std::size_t k = 1; k < first.size(); ++k) first[k] += first[k - 1];
  ends.resize(std::size_t(first.back()));
  std::vector<int> next = first;
  for_ends([&](int end, std::size_t node) { ends[next[node]++] = end; });
  std::vector<float> strength(t.chains.size(), 0.0f);  // mean strength of each chain
  tbb::parallel_for(std::size_t(0), strength.size(), [&](std::size_t k) {
    for (const ChainPoint& p : t.chains[k].points) strength[k] += p.strength / float(t.chains[k].points.size());
  });
  std::vector<int> mate(2 * t.chains.size(), -1);
  tbb::parallel_for(std::size_t(0), first.size() - 1, [&](std::size_t node) {
    const std::span<const int> at(ends.data() + first[node], ends.data() + first[node + 1]);
    if (at.size() > 1) pair_node(t, at, strength, mate);
  });
  concatenate(t, mate, false);
}

}  // namespace umbrage
