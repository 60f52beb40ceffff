// Makes chains of edges and joins them: find_chains, join_at_junctions, bridge_gaps and connect_ends.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>

#include "chains/grid.h"
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

namespace {

constexpr float kTurning = 2.0f;        // cost per squared turn in radians, relative to the gap's length
constexpr float kMaxSteepness = 10.0f;  // max depth change per pixel of a gap, in pixel sizes

/// A link that continues a free end: either to another free end or to an edge of another chain. Ends are numbered as in
/// Chain.
struct Link {
  float cost;
  int end, other, edge;  // the free end, and the other end or the edge; the one that does not apply is -1
};

/// The ends of all chains, indexed by their number.
struct Ends {
  std::vector<std::uint8_t> free;
  std::vector<Direction> direction;  // outward; only set for free ends
};

Ends ends_of(const Tracing& t) {
  Ends ends{t.free_ends(), std::vector<Direction>(2 * t.chains.size())};
  for (std::size_t end = 0; end < ends.free.size(); ++end)
    if (ends.free[end]) ends.direction[end] = end_direction(t.chains[end / 2], int(end % 2));
  return ends;
}

/// The parameters of the search for links.
struct Search {
  const PointGrid& grid;
  float reach;
  PixelSize pixel;
};

/// Appends the possible links of a free end to `links`. A turn is expressed by the cosine of the angle between the
/// direction of an end and that of the link.
void find_links(const Tracing& t, const Search& search, const Ends& ends, int end, std::vector<Link>& links) {
  const Chain& own = t.chains[end / 2];
  const ChainPoint& from = own.end(end % 2);
  const float to_side = 0.5f * std::min(search.reach, length_of(own));
  const int own_point = end % 2 ? int(own.points.size()) - 1 : 0;
  search.grid.near(from.x, from.y, search.reach, [&](const PointGrid::Entry& e, float d2) {
    const float d = std::sqrt(d2), dx = e.x - from.x, dy = e.y - from.y;
    if (e.chain == end / 2 && float(std::abs(e.point - own_point)) < 3.0f * d + 6.0f) return;
    const auto turn_of = [&](const Direction& direction, float sign) {
      return d > 0.1f ? sign * (direction[0] * dx + direction[1] * dy) / d : 1.0f;
    };
    const auto squared_angle = [](float cosine) { return 2.0f - 2.0f * cosine; };  // approximate
    const float turn = turn_of(ends.direction[end], 1.0f);
    if (turn < kMinStraightCosine) return;
    const Chain& other = t.chains[e.chain];
    const float behind = (other.points[e.point].depth - from.depth) / (search.pixel.at(from.depth) * (d + 1.0f));
    const bool at_first = e.point == 0, at_last = e.point + 1 == int(other.points.size());
    const int other_end = 2 * e.chain + (at_first ? 0 : 1);
    if ((at_first || at_last) && ends.free[other_end] && other_end != end) {
      const float other_turn = turn_of(ends.direction[other_end], -1.0f);
      if (other_end < end || other_turn < kMinStraightCosine || std::abs(behind) > kMaxSteepness) return;
      const float bend = squared_angle(turn) + squared_angle(other_turn);
      const float cost = d * (1.0f + kTurning * bend) + std::abs(behind) / kMaxSteepness;
      if (cost < search.reach) links.push_back({cost, end, other_end, -1});
    } else if (d <= to_side && behind < kMaxSteepness && e.edge >= 0) {
      links.push_back({(d + 0.5f) * (1.0f + kTurning * squared_angle(turn)), end, -1, e.edge});
    }
  });
}

}  // namespace

void bridge_gaps(Tracing& t, float reach, const PixelSize& pixel) {
  const PointGrid grid(t.chains, t.graph.width(), t.graph.height());
  Ends ends = ends_of(t);
  std::vector<Link> links;
  for (int end = 0; end < int(ends.free.size()); ++end)
    if (ends.free[end]) find_links(t, {grid, reach, pixel}, ends, end, links);
  std::sort(links.begin(), links.end(), [](const Link& a, const Link& b) {
    return std::tie(a.cost, a.end, a.other, a.edge) < std::tie(b.cost, b.end, b.other, b.edge);
  });
  std::vector<int> mate(ends.free.size(), -1);
  for (const Link& link : links) {
    if (!ends.free[link.end] || (link.other >= 0 && !ends.free[link.other])) continue;
    ends.free[link.end] = false;
    if (link.other < 0) {
      t.chains[link.end / 2].joined[link.end % 2] = link.edge;
      continue;
    }
    ends.free[link.other] = false;
    mate[link.end] = link.other;
    mate[link.other] = link.end;
  }
  concatenate(t, mate, true);
}

namespace {

/// The mean position of the chains that meet at a node. If any chain passes the node, chains that end there do not
/// count.
struct MeetingPoint {
  float x = 0.0f, y = 0.0f;
  int passing = 0, ends = 0;

  void add(float px, float py, bool passes) {
    if (passes && passing == 0) x = y = 0.0f;
    if (passes || passing == 0) x += px, y += py;
    passing += passes;
    ends += !passes;
  }
  std::array<float, 2> position() const {
    const auto count = float(passing > 0 ? passing : ends);
    return {x / count, y / count};
  }
};

void extend_to(Chain& chain, int last, std::array<float, 2> position) {
  constexpr float kMinExtension = 0.75f;  // pixels; an end that is nearer is moved instead
  ChainPoint& end = last ? chain.points.back() : chain.points.front();
  ChainPoint p = end;
  p.x = position[0], p.y = position[1];
  if (length_of(end.x - p.x, end.y - p.y) >= kMinExtension)
    chain.points.insert(last ? chain.points.end() : chain.points.begin(), p);
  else
    end = p;
}

}  // namespace

void connect_ends(Tracing& t) {
  constexpr float kBeyond = 2.0f;  // pixels by which a line extends beyond the picture's border
  std::vector<std::array<float, 2>> of_edge(std::size_t(t.graph.size()));
  std::vector<MeetingPoint> meetings(2 * std::size_t(t.graph.size()));
  for (const Chain& chain : t.chains) {
    for (std::size_t k = 0; k < chain.points.size(); ++k) {
      const ChainPoint &p = chain.points[k], &q = chain.points[(k + 1) % chain.points.size()];
      if (p.edge >= 0) of_edge[p.edge] = {p.x, p.y};
      if (p.node >= 0) meetings[p.node].add(0.5f * (p.x + q.x), 0.5f * (p.y + q.y), true);
    }
    for (int last = 0; last < 2 && !chain.closed; ++last)
      if (chain.node[last] >= 0) meetings[chain.node[last]].add(chain.end(last).x, chain.end(last).y, false);
  }
  for (Chain& chain : t.chains) {
    for (int last = 0; last < 2 && !chain.closed; ++last) {
      const int node = chain.node[last];
      if (chain.joined[last] >= 0) {
        extend_to(chain, last, of_edge[chain.joined[last]]);
      } else if (node >= 0 && meetings[node].passing + meetings[node].ends > 1) {
        extend_to(chain, last, meetings[node].position());
      } else if (node >= 0 && t.graph.at_border(t.graph.node(node))) {
        const auto [dx, dy] = end_direction(chain, last);
        extend_to(chain, last, {chain.end(last).x + kBeyond * dx, chain.end(last).y + kBeyond * dy});
      }
    }
    if (chain.closed) chain.points.push_back(ChainPoint(chain.points.front()));
  }
}

}  // namespace umbrage
