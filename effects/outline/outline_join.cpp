// Which chains stay, and what joins them: doubled lines, gaps, and what is too short for what it leads to.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "effects/outline/outline_chains.h"
#include "effects/outline/outline_grid.h"

namespace umbrage {
namespace {

// Doubled lines. All lengths grow.
constexpr float kBeside = 3.0f;    // pixels beside a chain, within which a fainter one of about its way is its double
constexpr float kMaxRest = 12.0f;  // pixels in a row of a double that may lie alone
// Gaps.
constexpr float kGap = 16.0f;           // pixels over which ends are joined
constexpr float kTurning = 2.0f;        // what a turn of a radian, squared, adds to a gap, times its length
constexpr float kMaxSteepness = 10.0f;  // pixel sizes of depth per pixel of a gap

float length(const Chain& chain) {
  float sum = 0.7f;
  for (std::size_t k = 1; k < chain.points.size(); ++k)
    sum += length_of(chain.points[k].x - chain.points[k - 1].x, chain.points[k].y - chain.points[k - 1].y);
  return sum;
}

/// By which chains stand for others: ids before depth discontinuities before creases.
float sureness(const ChainPoint& p) {
  return p.kind == kOutlineId ? 5.0f * kOutlineMaxStrength : p.kind == kOutlineDepth ? 2.0f * p.strength : p.strength;
}

/// Chains in the order in which they stand for others: surest first.
std::vector<int> by_rank(const std::vector<Chain>& chains) {
  std::vector<float> rank;
  for (const Chain& chain : chains) {
    float sum = 0.0f;
    for (const ChainPoint& p : chain.points) sum += sureness(p);
    const auto count = float(chain.points.size());
    rank.push_back(sum / count + 1e-3f * std::min(count, 500.0f));  // of equals the longer one
  }
  std::vector<int> order(chains.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return rank[std::size_t(a)] > rank[std::size_t(b)]; });
  return order;
}

/// What lies beside a point of a chain: an edge of a surer one.
struct Beside {
  int point, edge;
};

std::vector<Beside> find_beside(const Tracing& t, const PointGrid& grid, const std::vector<int>& rank, int of) {
  const Chain& chain = t.chains[std::size_t(of)];
  const float reach = kBeside * std::max(t.c.scale, 1.0f);  // no less than the pixels' grid has room for
  std::vector<Beside> found;
  for (int k = 0; k < int(chain.points.size()); ++k) {
    const ChainPoint& p = chain.points[std::size_t(k)];
    if (p.kind == kOutlineId) continue;
    const auto way = way_at(chain, k);
    grid.near(p.x, p.y, reach, [&](const PointGrid::Entry& e, float) {
      const bool surer = e.edge >= 0 && rank[std::size_t(e.chain)] < rank[std::size_t(of)];
      if (surer && std::abs(way[0] * e.dx + way[1] * e.dy) > kParallel) found.push_back({k, e.edge});
    });
  }
  return found;
}

/// Whether all of a chain lies beside others that stay, but for little at its ends or in between.
bool is_double(const std::vector<Beside>& beside, std::size_t points, const std::vector<std::uint8_t>& stays,
               float rest) {
  std::vector<std::uint8_t> doubled(points, 0);
  for (const Beside& b : beside) doubled[std::size_t(b.point)] |= stays[std::size_t(b.edge)];
  int count = 0, alone = 0, longest = 0;
  for (const bool d : doubled) {
    count += d;
    alone = d ? 0 : alone + 1;
    longest = std::max(longest, alone);
  }
  return float(longest) < rest && longest < count;
}

/// A way to go on from a free end: to another one, or to another chain's side.
struct Link {
  float cost;
  int end, other, edge;  // ends: 2 * chain + last; other -1: to the side at an edge
};

class Bridger {
 public:
  explicit Bridger(Tracing& t) : t_(t), grid_(t.chains, t.frame.frame.width, t.frame.frame.height) {
    const std::vector<int> meetings = t.meetings();
    lead_.resize(2 * t.chains.size());
    free_.resize(2 * t.chains.size());
    for (std::size_t end = 0; end < free_.size(); ++end) {
      const Chain& chain = t.chains[end / 2];
      free_[end] = t.is_free(chain, int(end % 2), meetings);
      if (free_[end]) lead_[end] = lead(chain, int(end % 2));
    }
  }

  void run() {
    std::vector<Link> links;
    for (int end = 0; end < int(free_.size()); ++end)
      if (free_[std::size_t(end)]) find(end, links);
    std::sort(links.begin(), links.end(), [](const Link& a, const Link& b) {
      return std::tie(a.cost, a.end, a.other, a.edge) < std::tie(b.cost, b.end, b.other, b.edge);
    });
    std::vector<int> mate(free_.size(), -1);
    for (const Link& link : links) {
      if (!free_[std::size_t(link.end)] || (link.other >= 0 && !free_[std::size_t(link.other)])) continue;
      free_[std::size_t(link.end)] = false;
      if (link.other < 0) {
        t_.chains[std::size_t(link.end / 2)].joined[std::size_t(link.end % 2)] = link.edge;
        continue;
      }
      free_[std::size_t(link.other)] = false;
      mate[std::size_t(link.end)] = link.other;
      mate[std::size_t(link.other)] = link.end;
    }
    concatenate(t_, mate, true);
  }

 private:
  void find(int end, std::vector<Link>& links) const {
    const Chain& own = t_.chains[std::size_t(end / 2)];
    const ChainPoint& from = own.end(end % 2);
    const Ray& ray = lead_[std::size_t(end)];
    const float reach = kGap * t_.c.scale, to_side = 0.5f * std::min(reach, length(own));
    const int own_point = end % 2 ? int(own.points.size()) - 1 : 0;
    grid_.near(from.x, from.y, reach, [&](const PointGrid::Entry& e, float d2) {
      const float d = std::sqrt(d2), dx = e.x - from.x, dy = e.y - from.y;
      if (e.chain == end / 2 && float(std::abs(e.point - own_point)) < 3.0f * d + 6.0f) return;
      const float cosine = d > 0.1f ? (ray.dx * dx + ray.dy * dy) / d : 1.0f;
      if (cosine < kStraightOn) return;
      const Chain& other = t_.chains[std::size_t(e.chain)];
      const float behind =
          (other.points[std::size_t(e.point)].depth - from.depth) / (t_.pixel(from.depth) * (d + 1.0f));
      const float turn = std::acos(std::min(cosine, 1.0f));
      const bool at_first = e.point == 0, at_last = e.point + 1 == int(other.points.size());
      const int other_end = 2 * e.chain + (at_first ? 0 : 1);
      if ((at_first || at_last) && free_[std::size_t(other_end)] && other_end != end) {
        if (other_end < end) return;  // found from there
        const Ray& back = lead_[std::size_t(other_end)];
        const float other_cosine = d > 0.1f ? -(back.dx * dx + back.dy * dy) / d : 1.0f;
        if (other_cosine < kStraightOn || std::abs(behind) > kMaxSteepness) return;
        const float other_turn = std::acos(std::min(other_cosine, 1.0f));
        const float cost =
            d * (1.0f + kTurning * (turn * turn + other_turn * other_turn)) + std::abs(behind) / kMaxSteepness;
        if (cost < reach) links.push_back({cost, end, other_end, -1});
      } else if (d <= to_side && behind < kMaxSteepness && e.edge >= 0) {
        links.push_back({(d + 0.5f) * (1.0f + kTurning * turn * turn), end, -1, e.edge});
      }
    });
  }

  Tracing& t_;
  PointGrid grid_;
  std::vector<Ray> lead_;           // by end
  std::vector<std::uint8_t> free_;  // by end
};

/// Which chains hang together: a number for each.
std::vector<int> groups(const Tracing& t) {
  std::vector<int> group(t.chains.size()), of_node(t.nodes.size(), -1), of_edge(std::size_t(t.graph.size()), -1);
  std::iota(group.begin(), group.end(), 0);
  const auto root = [&](int k) {
    while (group[std::size_t(k)] != k) k = group[std::size_t(k)] = group[std::size_t(group[std::size_t(k)])];
    return k;
  };
  const auto meet = [&](int chain, int node) {
    if (node < 0) return;
    int& other = of_node[std::size_t(node)];
    if (other >= 0) group[std::size_t(root(chain))] = root(other);
    other = chain;
  };
  for (int k = 0; k < int(t.chains.size()); ++k) {
    for (const int node : t.chains[std::size_t(k)].node) meet(k, node);
    for (const ChainPoint& p : t.chains[std::size_t(k)].points) {
      meet(k, p.node);
      if (p.edge >= 0) of_edge[std::size_t(p.edge)] = k;
    }
  }
  for (int k = 0; k < int(t.chains.size()); ++k)
    for (const int joined : t.chains[std::size_t(k)].joined)
      if (joined >= 0 && of_edge[std::size_t(joined)] >= 0)
        group[std::size_t(root(k))] = root(of_edge[std::size_t(joined)]);
  for (int k = 0; k < int(group.size()); ++k) group[std::size_t(k)] = root(k);
  return group;
}

}  // namespace

void drop_doubles(Tracing& t) {
  const std::vector<int> order = by_rank(t.chains);
  std::vector<int> rank(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) rank[std::size_t(order[k])] = int(k);
  const PointGrid grid(t.chains, t.frame.frame.width, t.frame.frame.height);
  std::vector<std::vector<Beside>> beside(t.chains.size());
  tbb::parallel_for(std::size_t(0), t.chains.size(),
                    [&](std::size_t k) { beside[k] = find_beside(t, grid, rank, int(k)); });
  std::vector<std::uint8_t> stays(std::size_t(t.graph.size()), 0);  // by edge
  for (const int k : order) {
    std::vector<ChainPoint>& points = t.chains[std::size_t(k)].points;
    if (is_double(beside[std::size_t(k)], points.size(), stays, kMaxRest * t.c.scale)) points.clear();
    for (const ChainPoint& p : points)
      if (p.edge >= 0) stays[std::size_t(p.edge)] = 1;
  }
  t.drop_empty();
}

void bridge_gaps(Tracing& t) { Bridger(t).run(); }

void drop_short(Tracing& t, float free_px, float branch_px) {
  constexpr int kRounds = 3;  // what went can leave others free
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<int> meetings = t.meetings(), group = groups(t);
    std::vector<float> total(t.chains.size(), 0.0f), own(t.chains.size());
    std::vector<std::uint8_t> is_object(t.chains.size(), 0);
    for (std::size_t k = 0; k < t.chains.size(); ++k) {
      own[k] = length(t.chains[k]);
      total[std::size_t(group[k])] += own[k];
      is_object[std::size_t(group[k])] |= has_id(t.chains[k]);
    }
    bool changed = false;
    for (std::size_t k = 0; k < t.chains.size(); ++k) {
      Chain& chain = t.chains[k];
      const bool free0 = t.is_free(chain, 0, meetings), free1 = t.is_free(chain, 1, meetings);
      float least = free0 && free1 ? free_px : free0 || free1 ? branch_px : 0.5f * branch_px;
      if (chain.closed || has_id(chain)) least = 0.0f;
      const float least_total = is_object[std::size_t(group[k])] ? 2.0f * branch_px : free_px;
      if (own[k] >= least * t.c.scale && total[std::size_t(group[k])] >= least_total * t.c.scale) continue;
      chain.points.clear();
      changed = true;
    }
    if (!changed) break;
    t.drop_empty();
  }
}

}  // namespace umbrage
