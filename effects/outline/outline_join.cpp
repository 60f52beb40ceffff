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
constexpr float kBeside = 4.5f;    // pixels beside a chain, within which a fainter one of its way may be its double,
constexpr float kMaxMean = 0.67f;  // and share of them that it lies off in the mean
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
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return rank[a] > rank[b]; });
  return order;
}

/// What lies beside a point of a chain: a surer one, and how far off.
struct Beside {
  int point, chain;
  float off;
};

std::vector<Beside> find_beside(const Tracing& t, const PointGrid& grid, const std::vector<int>& rank, int of) {
  const Chain& chain = t.chains[of];
  const float reach = kBeside * std::max(t.c.scale, 1.0f);  // no less than the pixels' grid has room for
  std::vector<Beside> found;
  for (int k = 0; k < int(chain.points.size()); ++k) {
    const ChainPoint& p = chain.points[k];
    if (p.kind == kOutlineId) continue;
    const auto way = way_at(chain, k);
    grid.near(p.x, p.y, reach, [&](const PointGrid::Entry& e, float d2) {
      if (rank[e.chain] >= rank[of] || std::abs(way[0] * e.dx + way[1] * e.dy) <= kParallel) return;
      found.push_back({k, e.chain, std::sqrt(d2) / reach});
    });
  }
  return found;
}

/// Whether all of a chain lies beside others that stay, but for little at its ends or in between, and near in the mean.
bool is_double(const std::vector<Beside>& beside, std::size_t points, const std::vector<std::uint8_t>& stays,
               float rest) {
  constexpr float kAlone = 2.0f;  // of the reach
  std::vector<float> off(points, kAlone);
  for (const Beside& b : beside)
    if (stays[b.chain]) off[b.point] = std::min(off[b.point], b.off);
  int count = 0, alone = 0, longest = 0;
  float sum = 0.0f;
  for (const float o : off) {
    const bool doubled = o < kAlone;
    count += doubled;
    sum += doubled ? o : 0.0f;
    alone = doubled ? 0 : alone + 1;
    longest = std::max(longest, alone);
  }
  return float(longest) < rest && longest < count && sum < kMaxMean * float(count);
}

/// A way to go on from a free end, 2 * chain + last: to another one, or to the side of another chain at an edge.
struct Link {
  float cost;
  int end, other, edge;  // other, edge: -1 where it is the other kind
};

/// What is known of ends.
struct Ends {
  std::vector<std::uint8_t> free;
  std::vector<Direction> lead;  // of those that are free
};

Ends ends_of(const Tracing& t) {
  const std::vector<int> meetings = t.meetings();
  Ends ends{std::vector<std::uint8_t>(2 * t.chains.size()), std::vector<Direction>(2 * t.chains.size())};
  for (std::size_t end = 0; end < ends.free.size(); ++end) {
    ends.free[end] = !t.chains[end / 2].points.empty() && t.is_free(t.chains[end / 2], int(end % 2), meetings);
    if (ends.free[end]) ends.lead[end] = lead(t.chains[end / 2], int(end % 2));
  }
  return ends;
}

/// Finds links of a free end. Each turn is the cosine between where an end leads and where the link does.
void find_links(const Tracing& t, const PointGrid& grid, const Ends& ends, int end, std::vector<Link>& links) {
  const Chain& own = t.chains[end / 2];
  const ChainPoint& from = own.end(end % 2);
  const float reach = kGap * t.c.scale, to_side = 0.5f * std::min(reach, length(own));
  const int own_point = end % 2 ? int(own.points.size()) - 1 : 0;
  grid.near(from.x, from.y, reach, [&](const PointGrid::Entry& e, float d2) {
    const float d = std::sqrt(d2), dx = e.x - from.x, dy = e.y - from.y;
    if (e.chain == end / 2 && float(std::abs(e.point - own_point)) < 3.0f * d + 6.0f) return;
    if (t.chains[e.chain].points.empty()) return;
    const auto turn_of = [&](const Direction& lead, float sign) {
      return d > 0.1f ? sign * (lead[0] * dx + lead[1] * dy) / d : 1.0f;
    };
    const auto squared_angle = [](float cosine) { return 2.0f - 2.0f * cosine; };  // about
    const float turn = turn_of(ends.lead[end], 1.0f);
    if (turn < kStraightOn) return;
    const Chain& other = t.chains[e.chain];
    const float behind = (other.points[e.point].depth - from.depth) / (t.pixel(from.depth) * (d + 1.0f));
    const bool at_first = e.point == 0, at_last = e.point + 1 == int(other.points.size());
    const int other_end = 2 * e.chain + (at_first ? 0 : 1);
    if ((at_first || at_last) && ends.free[other_end] && other_end != end) {
      const float other_turn = turn_of(ends.lead[other_end], -1.0f);
      if (other_end < end || other_turn < kStraightOn || std::abs(behind) > kMaxSteepness) return;
      const float bend = squared_angle(turn) + squared_angle(other_turn);
      const float cost = d * (1.0f + kTurning * bend) + std::abs(behind) / kMaxSteepness;
      if (cost < reach) links.push_back({cost, end, other_end, -1});
    } else if (d <= to_side && behind < kMaxSteepness && e.edge >= 0) {
      links.push_back({(d + 0.5f) * (1.0f + kTurning * squared_angle(turn)), end, -1, e.edge});
    }
  });
}

}  // namespace

void drop_doubles(Tracing& t, const PointGrid& grid) {
  const std::vector<int> order = by_rank(t.chains);
  std::vector<int> rank(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) rank[order[k]] = int(k);
  std::vector<std::vector<Beside>> beside(t.chains.size());
  tbb::parallel_for(std::size_t(0), t.chains.size(),
                    [&](std::size_t k) { beside[k] = find_beside(t, grid, rank, int(k)); });
  std::vector<std::uint8_t> stays(order.size(), 0);  // by chain
  for (const int k : order) {
    std::vector<ChainPoint>& points = t.chains[k].points;
    if (is_double(beside[k], points.size(), stays, kMaxRest * t.c.scale))
      points.clear();
    else
      stays[k] = 1;
  }
}

void bridge_gaps(Tracing& t, const PointGrid& grid) {
  Ends ends = ends_of(t);
  std::vector<Link> links;
  for (int end = 0; end < int(ends.free.size()); ++end)
    if (ends.free[end]) find_links(t, grid, ends, end, links);
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

void drop_short(Tracing& t, float free_px, float branch_px) {
  constexpr int kRounds = 3;  // what went can leave others free
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<int> meetings = t.meetings();
    const std::size_t before = t.chains.size();
    for (Chain& chain : t.chains) {
      const int free = t.is_free(chain, 0, meetings) + t.is_free(chain, 1, meetings);
      float least = free == 2 || chain.closed ? free_px : free == 1 ? branch_px : 0.5f * branch_px;
      if (has_id(chain)) least = free == 2 || chain.closed ? 2.0f * branch_px : 0.0f;
      if (length(chain) < least * t.c.scale) chain.points.clear();
    }
    t.drop_empty();
    if (t.chains.size() == before) break;
  }
}

}  // namespace umbrage
