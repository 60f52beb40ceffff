// Implements keep_clear_parts: cuts chains by the mean strength of their points.
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

}  // namespace umbrage
