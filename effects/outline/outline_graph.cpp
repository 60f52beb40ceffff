#include "effects/outline/outline_graph.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <optional>
#include <tuple>

namespace umbrage {
namespace {

/// The edge that a code at a pixel stands for, if it lies inside the picture.
std::optional<Edge> decoded(float value, int x, int y, bool below, int width, int height) {
  const auto code = std::uint32_t(value);
  Edge e{.x = x,
         .y = y,
         .below = below,
         .kind = std::uint8_t(code & 3),
         .strength = float(code >> 2 & 127) / 31.0f,
         .place = float(code >> 9 & 127) / 127.0f};
  (below ? e.y : e.x) += int(code >> 16) - kOutlineMaxWindow;
  const bool inside = e.x >= 0 && e.y >= 0 && e.x + !below < width && e.y + below < height;
  return inside && e.kind != 0 ? std::optional(e) : std::nullopt;
}

/// Whether an edge counts before another one in the same place, or none.
bool is_surer(const Edge& a, const Edge& b) {
  const auto key = [](const Edge& e) { return std::tuple(e.kind > kOutlineCrease, e.strength, e.place); };
  return b.kind == 0 || key(a) > key(b);
}

}  // namespace

EdgeGraph::EdgeGraph(const HostPlane& right, const HostPlane& below, int width, int height)
    : width_(width), height_(height), row_bits_((2 * std::size_t(width) + 4 + 63) / 64 * 64) {
  constexpr int kBlock = 32;                      // pixels wide and high
  constexpr int kMost = kBlock * kBlock * 3 / 2;  // edges of one: what has more is noise
  std::vector<std::vector<Edge>> found(std::size_t((height + kBlock - 1) / kBlock));
  tbb::parallel_for(std::size_t(0), found.size(), [&](std::size_t row_of_blocks) {
    std::vector<Edge>& edges = found[row_of_blocks];
    const int first = int(row_of_blocks) * kBlock;
    for (int y = first; y < std::min(first + kBlock, height); ++y)
      for (const bool is_below : {false, true}) {
        const float* row = (is_below ? below : right).row(y);
        for (int x = 0; x < width; ++x)
          if (row[x] > 0.0f)
            if (const auto e = decoded(row[x], x, y, is_below, width, height)) edges.push_back(*e);
      }
    std::vector<int> count(std::size_t(width / kBlock + 1), 0);
    for (const Edge& e : edges) ++count[e.x / kBlock];
    std::erase_if(edges, [&](const Edge& e) { return count[e.x / kBlock] > kMost; });
  });
  std::vector<Edge> all;
  for (const std::vector<Edge>& block : found) all.insert(all.end(), block.begin(), block.end());
  bits_.assign(row_bits_ / 64 * std::size_t(height_ + 2), 0);
  for (const Edge& e : all) bits_[bit(e) / 64] |= std::uint64_t(1) << (bit(e) % 64);
  fill_steps(all);
  number_edges(all);
}

void EdgeGraph::number_edges(const std::vector<Edge>& all) {
  before_.resize(bits_.size());
  int count = 0;
  for (std::size_t k = 0; k < bits_.size(); ++k) {
    before_[k] = count;
    count += std::popcount(bits_[k]);
  }
  edges_.resize(std::size_t(count));
  for (const Edge& e : all)
    if (Edge& there = edges_[number(e)]; is_surer(e, there)) there = e;
}

// Where a soft crease moves on by a pixel from one row to the next no pair of pixels lies across the step: closes it.
void EdgeGraph::fill_steps(std::vector<Edge>& edges) {
  const std::size_t count = edges.size();
  for (std::size_t k = 0; k < count; ++k)
    for (const Node node : {first_node(edges[k]), last_node(edges[k])}) {
      if (at_border(node) || degree(node) != 1) continue;
      const int from = std::countr_zero(ways(node));
      int best = -1, least = 2 * kWays + 1;
      for (int turn = 1; turn < kWays; ++turn) {
        const int way = (from + turn) % kWays, met = degree(next(node, way));
        const int cost = met + (turn == 2 ? 0 : 1);  // straight on before aside
        if (met == 0 || cost >= least) continue;
        least = cost;
        best = way;
      }
      if (best < 0) continue;
      Edge e = side(node, best);
      e.kind = edges[k].kind == kOutlineId ? kOutlineCrease : edges[k].kind;
      e.strength = edges[k].strength;
      bits_[bit(e) / 64] |= std::uint64_t(1) << (bit(e) % 64);
      edges.push_back(e);
    }
}

Edge EdgeGraph::side(Node node, int way) {
  const int x = column(node), y = row(node);
  const bool across = way % 2 == 0;  // up and down lie between a pixel and the one to its right
  return {.x = way == 1 ? x : x - 1, .y = way == 2 ? y : y - 1, .below = !across};
}

int EdgeGraph::number(const Edge& side) const {
  const std::size_t at = bit(side);
  return before_[at / 64] + std::popcount(bits_[at / 64] & ((std::uint64_t(1) << (at % 64)) - 1));
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
