// Selects the chains that remain: keep_clear_parts and drop_short.
#include <algorithm>

#include "chains/trace.h"

namespace umbrage {

void keep_clear_parts(Tracing& t, const Clarity& clarity) {
  std::vector<Chain> kept;
  std::vector<float> sum;
  for (Chain& chain : t.chains) {
    const int count = int(chain.points.size());
    sum.assign(1, 0.0f);
    for (const ChainPoint& p : chain.points) sum.push_back(sum.back() + std::min(p.strength, 2.0f * clarity.clear));
    const auto mean = [&](int k) {
      const int first = std::max(0, k - clarity.around), end = std::min(count, k + clarity.around + 1);
      return (sum[end] - sum[first]) / float(end - first);
    };
    for (int first = 0, end; first < count; first = end) {
      float max = 0.0f;
      for (end = first; end < count && mean(end) >= clarity.faint; ++end) max = std::max(max, mean(end));
      if (max > clarity.clear) {
        Chain part;
        const bool whole = first == 0 && end == count;
        part.closed = chain.closed && whole;
        part.weight = std::min((max - clarity.clear) / (clarity.full - clarity.clear), 1.0f);
        part.points.assign(chain.points.begin() + first, chain.points.begin() + end);
        if (first == 0) part.node[0] = chain.node[0];
        if (end == count) part.node[1] = chain.node[1];
        if (!whole) part.points.back().node = -1;  // also where a closed chain was cut: its end is no longer a junction
        kept.push_back(std::move(part));
      }
      end = std::max(end, first + 1);
    }
  }
  t.chains = std::move(kept);
}

namespace {

constexpr float kFullWeightLength = 1.5f;  // from this multiple of the min length on, a chain has full weight

/// Removes chains without points, and resets Chain::joined where it refers to an edge that no chain has any more.
void drop_empty(Tracing& t) {
  std::erase_if(t.chains, [](const Chain& chain) { return chain.points.empty(); });
  std::vector<std::uint8_t> in_use(std::size_t(t.graph.size()), 0);
  for (const Chain& chain : t.chains)
    for (const ChainPoint& p : chain.points)
      if (p.edge >= 0) in_use[p.edge] = 1;
  for (Chain& chain : t.chains)
    for (int& joined : chain.joined)
      if (joined >= 0 && !in_use[joined]) joined = -1;
}

}  // namespace

void drop_short(Tracing& t, const std::function<float(const Chain& chain, int free_ends)>& min_px) {
  std::vector<float> fraction;                                // length of each chain / its min length
  for (std::size_t before = 0; t.chains.size() != before;) {  // removed chains can leave ends of others free
    before = t.chains.size();
    const std::vector<std::uint8_t> free = t.free_ends();
    fraction.assign(before, kFullWeightLength);
    for (std::size_t k = 0; k < before; ++k) {
      Chain& chain = t.chains[k];
      const float min = min_px(chain, free[2 * k] + free[2 * k + 1]);
      if (min > 0.0f) fraction[k] = length_of(chain) / min;
      if (fraction[k] <= 1.0f) chain.points.clear();
    }
    drop_empty(t);
  }
  for (std::size_t k = 0; k < fraction.size(); ++k)
    t.chains[k].weight *= std::min((fraction[k] - 1.0f) / (kFullWeightLength - 1.0f), 1.0f);
}

}  // namespace umbrage
