// PointGrid: finds the points of chains near a position.
#pragma once
#include <algorithm>
#include <vector>

#include "chains/chains.h"

namespace umbrage {

class PointGrid {
 public:
  struct Entry {
    float x, y, dx, dy;  // position, and unit direction of the chain there
    int chain, point, edge;
  };

  /// Builds the grid of all points of chains in a picture of that size. Points outside the picture are put into the
  /// cells along its border.
  PointGrid(const std::vector<Chain>& chains, int width, int height);

  /// Calls visit(entry, squared distance) for all points whose distance from (x, y) is below `reach` pixels.
  template <class Visit>
  void near(float x, float y, float reach, const Visit& visit) const {
    const int x0 = column(x - reach), x1 = column(x + reach), y0 = row(y - reach), y1 = row(y + reach);
    for (int j = y0; j <= y1; ++j) {
      const std::size_t cells = std::size_t(j) * std::size_t(columns_);
      for (int k = first_[cells + std::size_t(x0)]; k < first_[cells + std::size_t(x1) + 1]; ++k) {
        const Entry& e = entries_[k];
        const float d2 = (e.x - x) * (e.x - x) + (e.y - y) * (e.y - y);
        if (d2 < reach * reach) visit(e, d2);
      }
    }
  }

  /// Returns the number of points in the 4 x 4 cells, 16 x 16 pixels, around a position.
  int count_around(float x, float y) const {
    const int x0 = column(x - 1.5f * kCell), x1 = column(x + 1.5f * kCell);
    int count = 0;
    for (int j = row(y - 1.5f * kCell); j <= row(y + 1.5f * kCell); ++j)
      count += first_[std::size_t(j) * std::size_t(columns_) + std::size_t(x1) + 1] -
               first_[std::size_t(j) * std::size_t(columns_) + std::size_t(x0)];
    return count;
  }

 private:
  static constexpr int kCell = 4;  // width and height of a cell, pixels

  int column(float x) const { return std::clamp(int(x) / kCell, 0, columns_ - 1); }
  int row(float y) const { return std::clamp(int(y) / kCell, 0, rows_ - 1); }
  std::size_t cell(float x, float y) const {
    return std::size_t(row(y)) * std::size_t(columns_) + std::size_t(column(x));
  }

  int columns_, rows_;
  std::vector<int> first_;  // index of each cell's first entry
  std::vector<Entry> entries_;
};

}  // namespace umbrage
