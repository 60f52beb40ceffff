#include "devices/cpu/cells.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "machine/kernel_frame.h"

namespace umbrage {
namespace {

static_assert(kTileCell == kCellWidth && kRowAlignment % kCellWidth == 0);
constexpr int kWordBits = 64;

/// Calls work(word, bit) for each bit that is set.
template <class Work>
void for_bits(const std::uint64_t* bits, int words, const Work& work) {
  for (int w = 0; w < words; ++w)
    for (std::uint64_t rest = bits[w]; rest != 0; rest &= rest - 1) work(w, std::countr_zero(rest));
}

float* pixels_of(Plane& plane, int y, int word, int bit) {
  return plane.row(y) + std::ptrdiff_t(word * kWordBits + bit) * kCellWidth;
}

void clear_pixels(Plane& plane, int y, const std::uint64_t* bits) {
  for_bits(bits, plane.cells()->words,
           [&](int w, int bit) { std::fill_n(pixels_of(plane, y, w, bit), kCellWidth, 0.0f); });
}

/// Bits up to `far` places beside each one too, over the ends of words.
void widen(std::uint64_t* bits, int words, int far) {
  for (; far > 0; --far) {
    std::uint64_t before = 0;  // the word before, as it was
    for (int w = 0; w < words; ++w) {
      const std::uint64_t own = bits[w], after = w + 1 < words ? bits[w + 1] : 0;
      bits[w] = own | own << 1 | own >> 1 | before >> (kWordBits - 1) | after << (kWordBits - 1);
      before = own;
    }
  }
}

}  // namespace

void find_near_cells(std::span<const NearCells> planes, int y, std::uint64_t* near) {
  const int words = planes[0].cells->words, width = planes[0].cells->width;
  std::fill_n(near, words, 0);
  std::uint64_t* const all = near;
  thread_local std::vector<std::uint64_t> own;
  own.resize(words);
  for (const NearCells& plane : planes) {
    std::fill(own.begin(), own.end(), 0);
    const int first = std::max(y - plane.rows, 0), last = std::min(y + plane.rows, plane.cells->height - 1);
    for (int row = first; row <= last; ++row)
      for (int w = 0; w < words; ++w) own[w] |= plane.cells->row(row)[w];
    widen(own.data(), words, (plane.columns + kCellWidth - 1) / kCellWidth);
    for (int w = 0; w < words; ++w) all[w] |= own[w];
  }
  // What was widened beyond the row's end.
  const int in_last = (width + kCellWidth - 1) / kCellWidth - (words - 1) * kWordBits;
  if (in_last < kWordBits) near[words - 1] &= (std::uint64_t(1) << in_last) - 1;
}

void keep_cells(Plane& plane, int y, const std::uint64_t* kept, bool clear_kept) {
  std::uint64_t* bits = plane.cells()->row(y);
  for (int w = 0; w < plane.cells()->words; ++w) bits[w] &= ~kept[w];
  clear_pixels(plane, y, bits);
  std::copy_n(kept, plane.cells()->words, bits);
  if (clear_kept) clear_pixels(plane, y, bits);
}

void note_cells(Plane& plane, int y) {
  std::uint64_t* bits = plane.cells()->row(y);
  for_bits(bits, plane.cells()->words, [&](int w, int bit) {
    std::uint32_t any = 0, pixels[kCellWidth];
    std::memcpy(pixels, pixels_of(plane, y, w, bit), sizeof(pixels));
    for (const std::uint32_t pixel : pixels) any |= pixel;
    if (any == 0) bits[w] &= ~(std::uint64_t(1) << bit);
  });
}

void keep_all_cells(Plane& plane, int y) {
  Cells& cells = *plane.cells();
  std::fill_n(cells.row(y), cells.words, ~std::uint64_t(0));
  const int in_last = (cells.width + kCellWidth - 1) / kCellWidth - (cells.words - 1) * kWordBits;
  if (in_last < kWordBits) cells.row(y)[cells.words - 1] = (std::uint64_t(1) << in_last) - 1;
}

}  // namespace umbrage
