// Implements connect_ends: extends the ends of chains to the chains that they meet.
#include "chains/trace.h"

namespace umbrage {
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
