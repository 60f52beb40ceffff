// Implements bridge_gaps: chooses the links between chains by a cost that combines length, turning and depth.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "chains/grid.h"
#include "chains/trace.h"

namespace umbrage {
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

}  // namespace umbrage
