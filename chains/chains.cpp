#include "chains/chains.h"

#include <algorithm>

namespace umbrage {
namespace {

constexpr int kEndPoints = 10;  // number of points at an end that determine its direction

/// Appends points, a pixel apart, between the last point and `to`.
void bridge(std::vector<ChainPoint>& points, const ChainPoint& to) {
  const ChainPoint from = points.back();
  const int count = int(length_of(to.x - from.x, to.y - from.y));
  for (int k = 1; k < count; ++k) {
    const float f = float(k) / float(count);
    ChainPoint p = from;
    p.x += (to.x - from.x) * f;
    p.y += (to.y - from.y) * f;
    p.depth += (to.depth - from.depth) * f;
    p.strength = std::min(from.strength, to.strength);
    p.drop = std::min(from.drop, to.drop);
    p.edge = p.node = -1;
    points.push_back(p);
  }
}

void append(Chain& to, const Chain& from, bool reversed) {
  const auto begin = std::ptrdiff_t(to.points.size());
  to.points.insert(to.points.end(), from.points.begin(), from.points.end());
  if (!reversed) return;
  std::reverse(to.points.begin() + begin, to.points.end());
  for (std::size_t k = std::size_t(begin); k + 1 < to.points.size(); ++k) to.points[k].node = to.points[k + 1].node;
  to.points.back().node = -1;
}

/// Returns, for each node, the number of chains that meet there. A chain that ends at the node counts once; a chain
/// that passes it counts twice.
std::vector<int> node_degrees(const Tracing& t) {
  std::vector<int> count(2 * std::size_t(t.graph.size()), 0);
  for (const Chain& chain : t.chains) {
    for (const int node : chain.node)
      if (node >= 0 && !chain.closed) ++count[node];
    for (const ChainPoint& p : chain.points)
      if (p.node >= 0) count[p.node] += 2;
  }
  return count;
}

}  // namespace

std::vector<std::uint8_t> Tracing::free_ends() const {
  const std::vector<int> count = node_degrees(*this);
  std::vector<std::uint8_t> free(2 * chains.size(), 0);
  for (std::size_t end = 0; end < free.size(); ++end) {
    const Chain& chain = chains[end / 2];
    const int node = chain.node[end % 2];
    if (chain.closed || chain.joined[end % 2] >= 0) continue;
    free[end] = node < 0 || (!graph.at_border(graph.node(node)) && count[node] < 2);
  }
  return free;
}

float length_of(const Chain& chain) {
  float sum = 0.7f;
  for (std::size_t k = 1; k < chain.points.size(); ++k)
    sum += length_of(chain.points[k].x - chain.points[k - 1].x, chain.points[k].y - chain.points[k - 1].y);
  return sum;
}

Direction chain_direction_at(const Chain& chain, int point) {
  constexpr int kAround = 4;
  const auto& first = chain.points[std::max(0, point - kAround)];
  const auto& last = chain.points[std::size_t(std::min(int(chain.points.size()) - 1, point + kAround))];
  const float dx = last.x - first.x, dy = last.y - first.y, length = std::max(length_of(dx, dy), 1e-6f);
  return {dx / length, dy / length};
}

Direction end_direction(const Chain& chain, int last) {
  const int count = std::min(kEndPoints, int(chain.points.size()));
  const ChainPoint* end = &chain.end(last);
  const int step = last ? -1 : 1;
  float mx = 0.0f, my = 0.0f, xx = 0.0f, xy = 0.0f, yy = 0.0f;
  for (int k = 0; k < count; ++k) {
    mx += end[k * step].x;
    my += end[k * step].y;
  }
  mx /= float(count);
  my /= float(count);
  for (int k = 0; k < count; ++k) {
    const float x = end[k * step].x - mx, y = end[k * step].y - my;
    xx += x * x;
    xy += x * y;
    yy += y * y;
  }
  // Computes the principal direction of the points, and turns it outwards.
  const float apart = length_of(xx - yy, 2.0f * xy);
  float dx = xx > yy ? xx - yy + apart : 2.0f * xy, dy = xx > yy ? 2.0f * xy : yy - xx + apart;
  const ChainPoint& inner = end[(count - 1) * step];
  const float length = std::max(length_of(dx, dy), 1e-30f);
  const float sign = (end->x - inner.x) * dx + (end->y - inner.y) * dy < 0.0f ? -1.0f : 1.0f;
  return {sign * dx / length, sign * dy / length};
}

void concatenate(Tracing& t, const std::vector<int>& mate, bool over_gaps) {
  std::vector<Chain> result;
  std::vector<std::uint8_t> used(t.chains.size(), 0);
  for (const bool closed : {false, true})
    for (int start = 0; start < 2 * int(t.chains.size()); ++start) {
      Chain& first = t.chains[start / 2];
      if (used[start / 2] || first.points.empty()) continue;
      if (!closed && (first.closed || mate[start] >= 0)) continue;
      if (mate[start] < 0 && mate[start ^ 1] < 0) {  // unchanged
        used[start / 2] = 1;
        result.push_back(std::move(first));
        continue;
      }
      Chain chain;
      chain.closed = closed;
      chain.weight = 0.0f;
      chain.node[0] = first.node[start % 2];
      chain.joined[0] = first.joined[start % 2];
      for (int at = start;;) {
        const Chain& next = t.chains[at / 2];
        used[at / 2] = 1;
        if (over_gaps && !chain.points.empty()) bridge(chain.points, next.end(at % 2));
        append(chain, next, at % 2 == 1);
        chain.weight = std::max(chain.weight, next.weight);
        const std::size_t far = std::size_t(1 - at % 2);
        chain.node[1] = next.node[far];
        chain.joined[1] = next.joined[far];
        at = mate[at ^ 1];
        if (at < 0) break;
        chain.points.back().node = over_gaps ? -1 : chain.node[1];
        if (used[at / 2]) break;
      }
      if (closed && over_gaps) bridge(chain.points, ChainPoint(chain.points.front()));
      result.push_back(std::move(chain));
    }
  t.chains = std::move(result);
}

}  // namespace umbrage
