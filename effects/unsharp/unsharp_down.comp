// Second step of `unsharp` without a threshold on a GPU: computes running sums down the columns from the sums of
// unsharp_across.comp. Each invocation processes one column. The functions of unsharp.kernel.h give the result.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/unsharp/unsharp.h"
UMBRAGE_CONSTANTS(UnsharpConstants)
#include "effects/unsharp/unsharp_sums.h"
#include "effects/unsharp/unsharp_words.glsl"
#include "kernel/common.kernel.h"

#include "effects/unsharp/unsharp.kernel.h"

PLANE(UintPlane, unsharp_row_high)
PLANE(UintPlane, unsharp_row_low)

// The sum of samples, as two words, and their number.
struct Sums {
  uint high, low, number;
};

// Returns the sums of unsharp_across.comp at column x of row y; outside the picture by the border mode.
Sums row_sums(int x, int y) {
  uint width = uint(C.last_column - C.first_column + 1);
  if (y < 0 || y >= F.height) {
    if (C.border == kUnsharpBorderSkip) return Sums(0u, 0u, 0u);
    if (C.border == kUnsharpBorderZero) {
      uvec2 words = words_of(uint(int(C.border_depth)));
      return Sums(width * (words.x & kHighMask), width * words.y, width);
    }
    if (C.border == kUnsharpBorderRepeat) y -= int(floor((float(y) + 0.5f) / float(F.height))) * F.height;
  }
  int at = clamp(y, 0, F.height - 1) * F.stride + x;
  uint words = unsharp_row_high_plane().at[at];
  return Sums(words & kHighMask, unsharp_row_low_plane().at[at], words >> kNumberShift);
}

void main() {
  here.x = int(gl_WorkGroupID.x) * kUnsharpStripWidth + int(gl_LocalInvocationIndex);
  if (here.x >= F.width) return;
  int top = int(gl_WorkGroupID.y) * kUnsharpStripHeight;
  int bottom = min(top + kUnsharpStripHeight, F.height);
  Sums sums = Sums(0u, 0u, 0u);
  for (int y = top + C.first_row; y < top + C.last_row; ++y) {
    Sums row = row_sums(here.x, y);
    sums.high += row.high;
    sums.low += row.low;
    sums.number += row.number;
  }
  for (int y = top; y < bottom; ++y) {
    Sums entering = row_sums(here.x, y + C.last_row);
    sums.high += entering.high;
    sums.low += entering.low;
    sums.number += entering.number;
    here.y = y;
    uint samples = max(sums.number, 1u);
    float centre = near_unsharp_depth(0, 0);
    float excess = excess_from_sum(sums.high, sums.low, samples, uint(int(max(centre, 0.0f))));
    float value = ao_from_excess(excess, to_real(samples));
    store_ao(is_finite(near_depth(0, 0)) ? value : 1.0f);
    Sums leaving = row_sums(here.x, y + C.first_row);
    sums.high -= leaving.high;
    sums.low -= leaving.low;
    sums.number -= leaving.number;
  }
}
