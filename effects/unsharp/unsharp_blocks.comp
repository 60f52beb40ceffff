// Last step of `unsharp` with a threshold on a GPU: divides the window into blocks of 16, 8 and 4 samples a side, whose
// min, max and sum are known. A block entirely within the threshold is added at once, one entirely outside is skipped,
// and any other is subdivided. The result is bitwise identical to that of unsharp.kernel.h, whose functions it uses,
// since sums of integer steps are exact in any order.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/unsharp/unsharp.h"
UMBRAGE_CONSTANTS(UnsharpConstants)
#include "effects/unsharp/unsharp_words.glsl"
#include "kernel/common.kernel.h"

#include "effects/unsharp/unsharp.kernel.h"

IN_REAL(unsharp_min4)
IN_REAL(unsharp_max4)
PLANE(UintPlane, unsharp_sum4)
IN_REAL(unsharp_min8)
IN_REAL(unsharp_max8)
PLANE(UintPlane, unsharp_sum8)
IN_REAL(unsharp_min16)
IN_REAL(unsharp_max16)
PLANE(UintPlane, unsharp_sum16)

// Sum and number of the samples that count; sum_low can exceed 12 bits.
uint sum_high = 0u, sum_low = 0u, number = 0u;
float centre;

// Adds a block all of whose samples count. Adds its min times its number of samples, and then the remainder of its sum,
// which is correct even if the sum has overflowed.
void add_whole(uint sum, float min_value, uint samples) {
  uint lowest = uint(int(min_value));
  uint more = sum - lowest * samples;
  sum_high += (lowest >> kSplit) * samples + (more >> kSplit);
  sum_low += (lowest & kSplitMask) * samples + (more & kSplitMask);
  sum_high += sum_low >> kSplit;
  sum_low &= kSplitMask;
  number += samples;
}

bool all_count(float min_value, float max_value) { return counts(min_value, centre) && counts(max_value, centre); }
bool none_counts(float min_value, float max_value) {
  return max_value < 0.0f || centre - max_value >= C.threshold || min_value - centre >= C.threshold;
}

// These functions add a rectangle of samples, whose size is a multiple of the block size; right and bottom are
// exclusive.
void add_samples(int left, int top, int right, int bottom) {
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x) {
      float tap = read_unsharp_depth(y * F.stride + x);
      if (!counts(tap, centre)) continue;
      uint steps = uint(int(tap));
      sum_high += steps >> kSplit;
      sum_low += steps & kSplitMask;
      ++number;
    }
}
void add_blocks4(int left, int top, int right, int bottom) {
  for (int y = top; y < bottom; y += 4)
    for (int x = left; x < right; x += 4) {
      int block = y * F.stride + x;
      float min_value = read_unsharp_min4(block), max_value = read_unsharp_max4(block);
      if (all_count(min_value, max_value))
        add_whole(unsharp_sum4_plane().at[block], min_value, 16u);
      else if (!none_counts(min_value, max_value))
        add_samples(x, y, x + 4, y + 4);
    }
}
void add_blocks8(int left, int top, int right, int bottom) {
  for (int y = top; y < bottom; y += 8)
    for (int x = left; x < right; x += 8) {
      int block = y * F.stride + x;
      float min_value = read_unsharp_min8(block), max_value = read_unsharp_max8(block);
      if (all_count(min_value, max_value))
        add_whole(unsharp_sum8_plane().at[block], min_value, 64u);
      else if (!none_counts(min_value, max_value))
        add_blocks4(x, y, x + 8, y + 8);
    }
}
void add_blocks16(int left, int top, int right, int bottom) {
  for (int y = top; y < bottom; y += 16)
    for (int x = left; x < right; x += 16) {
      int block = y * F.stride + x;
      float min_value = read_unsharp_min16(block), max_value = read_unsharp_max16(block);
      if (all_count(min_value, max_value))
        add_whole(unsharp_sum16_plane().at[block], min_value, 256u);
      else if (!none_counts(min_value, max_value))
        add_blocks8(x, y, x + 16, y + 16);
    }
}

void blocks_pixel(int px, int py) {
  if (!is_finite(near_depth(0, 0))) {
    store_ao(1.0f);
    return;
  }
  centre = near_unsharp_depth(0, 0);
  // Divides the part of the window inside the picture into blocks of 16; to the right and below these into blocks of 8,
  // and so on.
  int left = max(px + C.first_column, 0), right = min(px + C.last_column + 1, F.width);
  int top = max(py + C.first_row, 0), bottom = min(py + C.last_row + 1, F.height);
  int width = right - left, height = bottom - top;
  int right16 = left + (width & ~15), right8 = left + (width & ~7), right4 = left + (width & ~3);
  int bottom16 = top + (height & ~15), bottom8 = top + (height & ~7), bottom4 = top + (height & ~3);
  add_blocks16(left, top, right16, bottom16);
  add_blocks8(right16, top, right8, bottom16);
  add_blocks8(left, bottom16, right8, bottom8);
  add_blocks4(right8, top, right4, bottom8);
  add_blocks4(left, bottom8, right4, bottom4);
  add_samples(right4, top, right, bottom4);
  add_samples(left, bottom4, right, bottom);
  if (C.border == kUnsharpBorderZero && counts(C.border_depth, centre)) {
    int side = C.last_column - C.first_column + 1;
    uint outside = uint(side * side - width * height);
    uint steps = uint(int(C.border_depth));
    sum_high += outside * (steps >> kSplit) + (sum_low >> kSplit);
    sum_low = (sum_low & kSplitMask) + outside * (steps & kSplitMask);
    number += outside;
  }
  uint samples = max(number, 1u);
  float excess = excess_from_sum(sum_high, sum_low, samples, uint(int(max(centre, 0.0f))));
  store_ao(ao_from_excess(excess, to_real(samples)));
}
UMBRAGE_MAIN(blocks)
