// What joins chains over gaps, and which are too short for what they lead to.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "effects/outline/outline_chains.h"
#include "effects/outline/outline_grid.h"

namespace umbrage {
namespace {

// All lengths grow.
constexpr float kAllLong = 1.5f;        // times the length that a chain must have, at which it has all of its width
constexpr float kGap = 16.0f;           // pixels over which ends are joined
constexpr float kTurning = 2.0f;        // what a turn of a radian, squared, adds to a gap, times its length
constexpr float kMaxSteepness = 10.0f;  // pixel sizes of depth per pixel of a gap

bool has_id(const Chain& chain) {
  return std::any_of(chain.points.begin(), chain.points.end(),
                     [](const ChainPoint& p) { return p.kind == kOutlineId; });
}

float length(const Chain& chain) {
  float sum = 0.7f;
  for (std::size_t k = 1; k < chain.points.size(); ++k)
    sum += length_of(chain.points[k].x - chain.points[k - 1].x, chain.points[k].y - chain.points[k - 1].y);
  return sum;
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
    ends.free[end] = t.is_free(t.chains[end / 2], int(end % 2), meetings);
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

void bridge_gaps(Tracing& t) {
  const PointGrid grid(t.chains, t.frame.frame.width, t.frame.frame.height);
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
  // How long a chain is, in units of what it must be.
  const auto share_of = [&](const Chain& chain, const std::vector<int>& meetings) {
    const int free = t.is_free(chain, 0, meetings) + t.is_free(chain, 1, meetings);
    const bool alone = free == 2 || chain.closed;
    float least = (alone ? free_px : branch_px) * t.c.scale;
    if (free == 0 && !chain.closed)
      least = 0.5f * branch_px * std::max(t.c.scale, 1.0f);  // slivers of the pixels' grid
    if (has_id(chain)) least = alone ? 2.0f * branch_px * t.c.scale : 0.0f;
    return least > 0.0f ? length(chain) / least : kAllLong;
  };
  std::vector<int> meetings;
  for (std::size_t before = 0; t.chains.size() != before;) {  // what went can leave others free
    before = t.chains.size();
    meetings = t.meetings();
    for (Chain& chain : t.chains)
      if (share_of(chain, meetings) <= 1.0f) chain.points.clear();
    t.drop_empty();
  }
  for (Chain& chain : t.chains) chain.weight *= std::min((share_of(chain, meetings) - 1.0f) / (kAllLong - 1.0f), 1.0f);
}

}  // namespace umbrage
