#include "chains/graph.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include "core/check.h"

namespace umbrage {

std::vector<Edge> without_noise(std::vector<Edge> edges, int width) {
  constexpr int kBlock = 32;                     // pixels wide and high
  constexpr int kMax = kBlock * kBlock * 3 / 2;  // max number of edges per block
  const int columns = width / kBlock + 1;
  int first = std::numeric_limits<int>::max(), last = 0;  // rows of blocks
  for (const Edge& e : edges) first = std::min(first, e.y / kBlock), last = std::max(last, e.y / kBlock);
  if (edges.empty()) return edges;
  const auto block_of = [&](const Edge& e) {
    return std::size_t(e.y / kBlock - first) * std::size_t(columns) + std::size_t(e.x / kBlock);
  };
  std::vector<int> count(std::size_t(last - first + 1) * std::size_t(columns), 0);
  for (const Edge& e : edges) ++count[block_of(e)];
  std::erase_if(edges, [&](const Edge& e) { return count[block_of(e)] > kMax; });
  return edges;
}

EdgeGraph::EdgeGraph(std::vector<Edge> edges, int width, int height)
    : width_(width), height_(height), row_bits_((2 * std::size_t(width) + 4 + 63) / 64 * 64) {
  bits_.assign(row_bits_ / 64 * std::size_t(height_ + 2), 0);
  for (const Edge& e : edges) {
    const bool inside = e.x >= 0 && e.y >= 0 && e.x + !e.below < width && e.y + e.below < height;
    if (!inside || e.kind == 0) fail_check(fmt::format("an edge of kind {} at ({}, {})", e.kind, e.x, e.y));
    set(e);
  }
  add_steps(edges);
  number_edges(edges);
}

void EdgeGraph::number_edges(const std::vector<Edge>& all) {
  edges_before_.resize(bits_.size());
  int count = 0;
  for (std::size_t k = 0; k < bits_.size(); ++k) {
    edges_before_[k] = count;
    count += std::popcount(bits_[k]);
  }
  edges_.resize(std::size_t(count));
  for (const Edge& e : all)
    if (Edge& there = edges_[number(e)];
        std::tie(e.kind, e.strength, e.place) > std::tie(there.kind, there.strength, there.place))
      there = e;
}

// Edges are detected in each row or column by itself. Where a line moves by a pixel from one to the next, the side
// between the two edges is missing.
void EdgeGraph::add_steps(std::vector<Edge>& edges) {
  const std::size_t count = edges.size();
  for (std::size_t k = 0; k < count; ++k)
    for (const Node node : {first_node(edges[k]), last_node(edges[k])}) {
      if (at_border(node) || degree(node) != 1) continue;
      const int from = std::countr_zero(ways(node));
      int best = -1, min = 2 * kWays + 1;
      for (int turn = 1; turn < kWays; ++turn) {
        const int way = (from + turn) % kWays, met = degree(next(node, way));
        const int cost = met + (turn == 2 ? 0 : 1);  // prefers to continue straight
        if (met == 0 || cost >= min) continue;
        min = cost;
        best = way;
      }
      if (best < 0) continue;
      Edge e = side(node, best);
      e.kind = e.step_kind = edges[k].step_kind;
      e.strength = edges[k].strength;
      set(e);
      edges.push_back(e);
    }
}

Edge EdgeGraph::side(Node node, int way) {
  const int x = column(node), y = row(node);
  const bool across = way % 2 == 0;  // up and down are between a pixel and its right neighbour
  return {.x = way == 1 ? x : x - 1, .y = way == 2 ? y : y - 1, .below = !across};
}

int EdgeGraph::number(const Edge& side) const {
  const std::size_t at = bit(side);
  return edges_before_[at / 64] + std::popcount(bits_[at / 64] & ((std::uint64_t(1) << (at % 64)) - 1));
}

unsigned EdgeGraph::ways(Node node) const {
  const std::size_t above = std::size_t(row(node)) * row_bits_ + 2 * std::size_t(column(node)),
                    under = above + row_bits_;
  const auto at = [&](std::size_t bit) { return unsigned(bits_[bit / 64] >> (bit % 64) & 1); };
  return at(above) | at(above + 3) << 1 | at(under) << 2 | at(above + 1) << 3;
}

EdgeGraph::Node EdgeGraph::next(Node node, int way) {
  const std::array<Node, kWays> step = {-node_at(0, 1), 1, node_at(0, 1), -1};
  return node + step[way];
}

bool EdgeGraph::at_border(Node node) const {
  const int x = column(node), y = row(node);
  return x == 0 || y == 0 || x == width_ || y == height_;
}

EdgeGraph::Node EdgeGraph::first_node(const Edge& e) { return e.below ? node_at(e.x, e.y + 1) : node_at(e.x + 1, e.y); }

int EdgeGraph::number_of(Node node) const {
  const int edge = number(side(node, std::countr_zero(ways(node))));
  return 2 * edge + (node == last_node(edge));
}

}  // namespace umbrage
