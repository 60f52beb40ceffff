// `unsharp` without a threshold, on a GPU, first step: the sums of the window's width in each row. A workgroup computes
// prefix sums of the row's samples once; a window's sum is then a difference of two of them. The second step is
// unsharp_down.comp. Must be bitwise identical to unsharp.kernel.h.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/unsharp/unsharp.h"
UMBRAGE_CONSTANTS(UnsharpConstants)
#include "effects/unsharp/unsharp_sums.h"
#include "effects/unsharp/unsharp_words.glsl"

IN_REAL(unsharp_depth)
PLANE(UintPlane, unsharp_row_high, 0)
PLANE(UintPlane, unsharp_row_low, 0)

const int kInvocations = 64;
const int kClump = 8;  // invocations per clump, whose sums are added first
const int kMaxSamples = kUnsharpSegment + kUnsharpMaxKernel - 1;

// Sums of the samples to the left of each sample, and of all of them; then of each invocation's part, and of each
// clump.
shared uint high_before[kMaxSamples + 1], low_before[kMaxSamples + 1];
shared uint high_share[kInvocations], low_share[kInvocations];
shared uint high_clump[kInvocations / kClump], low_clump[kInvocations / kClump];

// Returns the words of column `x` in row `y`; outside the picture by the border mode.
uvec2 sample_at(int x, int y) {
  if (x < 0 || x >= F.width) {
    if (C.border == kUnsharpBorderSkip) return uvec2(0u);
    if (C.border == kUnsharpBorderZero) return words_of(uint(int(C.border_depth)));
    if (C.border == kUnsharpBorderRepeat) x -= int(floor((float(x) + 0.5f) / float(F.width))) * F.width;
  }
  float steps = load_unsharp_depth(x, y);
  return steps >= 0.0f ? words_of(uint(int(steps))) : uvec2(0u);
}

void main() {
  int own = int(gl_LocalInvocationIndex);
  int left = int(gl_WorkGroupID.x) * kUnsharpSegment;
  int y = int(gl_WorkGroupID.y);
  int window = C.last_column - C.first_column + 1;
  int pixels = min(kUnsharpSegment, F.width - left);
  int samples = pixels + window - 1;
  int fraction = (samples + kInvocations - 1) / kInvocations;

  // Adjacent invocations read adjacent samples; then each invocation sums its own part.
  for (int k = own; k < samples; k += kInvocations) {
    uvec2 words = sample_at(left + C.first_column + k, y);
    high_before[k] = words.x;
    low_before[k] = words.y;
  }
  barrier();
  int begin = min(own * fraction, samples), end = min(begin + fraction, samples);
  uint high = 0u, low = 0u;
  for (int k = begin; k < end; ++k) {
    uint next_high = high + high_before[k], next_low = low + low_before[k];
    high_before[k] = high;
    low_before[k] = low;
    high = next_high;
    low = next_low;
  }
  high_share[own] = high;
  low_share[own] = low;
  barrier();
  if (own < kInvocations / kClump) {
    uint clump_high = 0u, clump_low = 0u;
    for (int k = own * kClump; k < (own + 1) * kClump; ++k) {
      clump_high += high_share[k];
      clump_low += low_share[k];
    }
    high_clump[own] = clump_high;
    low_clump[own] = clump_low;
  }
  barrier();
  uint high_left = 0u, low_left = 0u;  // of all parts to the left of this one
  for (int k = 0; k < own / kClump; ++k) {
    high_left += high_clump[k];
    low_left += low_clump[k];
  }
  for (int k = own / kClump * kClump; k < own; ++k) {
    high_left += high_share[k];
    low_left += low_share[k];
  }
  for (int k = begin; k < end; ++k) {
    high_before[k] += high_left;
    low_before[k] += low_left;
  }
  if (own == kInvocations - 1) {
    high_before[samples] = high_left + high;
    low_before[samples] = low_left + low;
  }
  barrier();
  // The words may have overflowed: a difference is correct nevertheless.
  for (int k = own; k < pixels; k += kInvocations) {
    int at = y * F.stride + left + k;
    unsharp_row_high_plane().at[at] = high_before[k + window] - high_before[k];
    unsharp_row_low_plane().at[at] = low_before[k + window] - low_before[k];
  }
}
