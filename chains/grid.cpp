#include "chains/grid.h"

#include <tbb/parallel_for.h>

namespace umbrage {

PointGrid::PointGrid(const std::vector<Chain>& chains, int width, int height)
    : columns_(width / kCell + 1),
      rows_(height / kCell + 1),
      first_(std::size_t(columns_) * std::size_t(rows_) + 1, 0) {
  std::vector<std::size_t> begin(chains.size() + 1, 0);
  for (std::size_t c = 0; c < chains.size(); ++c) {
    begin[c + 1] = begin[c] + chains[c].points.size();
    for (const ChainPoint& p : chains[c].points) ++first_[cell(p.x, p.y) + 1];
  }
  for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
  std::vector<int> next(first_.begin(), first_.end() - 1), place;
  place.reserve(begin.back());
  for (const Chain& chain : chains)
    for (const ChainPoint& p : chain.points) place.push_back(next[cell(p.x, p.y)]++);
  entries_.resize(begin.back());
  tbb::parallel_for(std::size_t(0), chains.size(), [&](std::size_t c) {
    for (std::size_t k = 0; k < chains[c].points.size(); ++k) {
      const ChainPoint& p = chains[c].points[k];
      const auto [dx, dy] = chain_direction_at(chains[c], int(k));
      entries_[place[begin[c] + k]] = {p.x, p.y, dx, dy, int(c), int(k), p.edge};
    }
  });
}

}  // namespace umbrage
