#include "renderer/masks.h"

#include <algorithm>
#include <vector>

namespace umbrage {

Plane grown(const Plane& from, const Margin& by) {
  Plane across(from.width, from.height, 0.0f), all(from.width, from.height, 0.0f);
  for (int y = 0; y < from.height; ++y)
    for (int x = 0, end = 0; x < from.width; ++x)
      if (from.row(y)[x] > 0.0f)
        for (end = std::max(end, x - by.columns); end <= std::min(x + by.columns, from.width - 1); ++end)
          across.row(y)[end] = 1.0f;
  std::vector<int> end(std::size_t(from.width));  // of each column: rows above are done
  for (int y = 0; y < from.height; ++y)
    for (int x = 0; x < from.width; ++x)
      if (across.row(y)[x] > 0.0f) {
        int& row = end[std::size_t(x)];
        for (row = std::max(row, y - by.rows); row <= std::min(y + by.rows, from.height - 1); ++row)
          all.row(row)[x] = 1.0f;
      }
  return all;
}

namespace {

constexpr int kBlock = 4;  // side of the blocks of pixels that are captured together, in strips and in whole pictures

}  // namespace

int block_end(int row) { return (row + kBlock - 1) / kBlock * kBlock; }

PixelMask with_whole_blocks(PixelMask mask) {
  const int width = mask.plane.width, end = mask.first_row + mask.plane.height;
  for (int y0 = mask.first_row; y0 < end; y0 += kBlock)
    for (int x0 = 0; x0 < width; x0 += kBlock) {
      const int x1 = std::min(x0 + kBlock, width), y1 = std::min(y0 + kBlock, end);
      if (!mask.any(x0, x1, y0, y1)) continue;
      for (int y = y0; y < y1; ++y) std::fill_n(mask.plane.row(y - mask.first_row) + x0, x1 - x0, 1.0f);
    }
  return mask;
}

Rows rows_of(const PixelMask& mask, const Rows& within) {
  Rows rows{within.end, within.begin};
  for (int y = within.begin; y < within.end; ++y)
    if (mask.any(0, mask.plane.width, y, y + 1)) rows = {std::min(rows.begin, y), y + 1};
  if (rows.count() <= 0) return {};
  return {rows.begin / kBlock * kBlock, std::min(block_end(rows.end), within.end)};
}

}  // namespace umbrage
