#include "devices/cpu/cells.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "core/check.h"
#include "machine/kernel_frame.h"

namespace umbrage {
namespace {

static_assert(kTileCell == kCellWidth && kRowAlignment % kCellWidth == 0);

float* pixels_of(Plane& plane, int y, int word, int bit) {
  return plane.row(y) + std::ptrdiff_t(word * kCellsInWord + bit) * kCellWidth;
}

void clear_pixels(Plane& plane, int y, int word, std::uint64_t bits) {
  for (; bits != 0; bits &= bits - 1) std::fill_n(pixels_of(plane, y, word, std::countr_zero(bits)), kCellWidth, 0.0f);
}

bool holds_something(const float* pixels) {
  std::array<std::uint64_t, kCellWidth / 2> bits;
  std::memcpy(bits.data(), pixels, sizeof(bits));
  std::uint64_t any = 0;
  for (const std::uint64_t two : bits) any |= two;
  return any != 0;
}

/// Those of a word's cells that are in the row.
std::uint64_t in_row(const Cells& cells, int word) {
  const int count = cells.in_row - word * kCellsInWord;
  return count < kCellsInWord ? (std::uint64_t(1) << count) - 1 : ~std::uint64_t(0);
}

/// Word w of the cells of row y, and of as many rows around as the plane counts.
std::uint64_t word_of_rows(const NearCells& plane, int y, int w) {
  const Cells& cells = *plane.cells;
  if (w < 0 || w >= cells.words) return 0;
  std::uint64_t any = 0;
  const int last = std::min(y + plane.rows, cells.height - 1);
  for (int row = std::max(y - plane.rows, 0); row <= last; ++row) any |= cells.row(row)[w];
  return any;
}

}  // namespace

void find_near_cells(std::span<const NearCells> planes, int y, std::uint64_t* near) {
  const Cells& cells = *planes[0].cells;
  for (int w = 0; w < cells.words; ++w) {
    std::uint64_t any = 0;
    for (const NearCells& plane : planes) {
      const std::uint64_t own = word_of_rows(plane, y, w);
      any |= own;
      const int far = (plane.columns + kCellWidth - 1) / kCellWidth;
      check_less(far, kCellsInWord, "cells from a pixel to what counts there");
      if (far == 0) continue;
      const std::uint64_t before = word_of_rows(plane, y, w - 1), after = word_of_rows(plane, y, w + 1);
      for (int k = 1; k <= far; ++k)
        any |= own << k | own >> k | before >> (kCellsInWord - k) | after << (kCellsInWord - k);
    }
    near[w] = any & in_row(cells, w);
  }
}

void keep_cells(Plane& plane, int y, const std::uint64_t* kept, bool clear_kept) {
  std::uint64_t* bits = plane.cells()->row(y);
  for (int w = 0; w < plane.cells()->words; ++w) {
    clear_pixels(plane, y, w, clear_kept ? bits[w] : bits[w] & ~kept[w]);
    bits[w] = kept[w];
  }
}

void note_cells(Plane& plane, int y) {
  std::uint64_t* bits = plane.cells()->row(y);
  for (int w = 0; w < plane.cells()->words; ++w) {
    std::uint64_t found = 0;
    for (std::uint64_t rest = bits[w]; rest != 0; rest &= rest - 1) {
      const int bit = std::countr_zero(rest);
      found |= std::uint64_t(holds_something(pixels_of(plane, y, w, bit))) << bit;
    }
    bits[w] = found;
  }
}

void keep_all_cells(Plane& plane, int y) {
  Cells& cells = *plane.cells();
  for (int w = 0; w < cells.words; ++w) cells.row(y)[w] = in_row(cells, w);
}

}  // namespace umbrage
