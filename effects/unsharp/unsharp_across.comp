// First step of `unsharp` without a threshold on a GPU: computes, for each pixel, the sum over the window's columns in
// its row. A workgroup computes prefix sums of a part of a row; a window's sum is the difference of two of these. The
// second step is unsharp_down.comp. The result must be bitwise identical to that of unsharp.kernel.h.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/unsharp/unsharp.h"
UMBRAGE_CONSTANTS(UnsharpConstants)
#include "effects/unsharp/unsharp_sums.h"
#include "effects/unsharp/unsharp_words.glsl"

IN_REAL(unsharp_depth)
PLANE(UintPlane, unsharp_row_high)
PLANE(UintPlane, unsharp_row_low)

const int kInvocations = 64;
const int kGroup = 8;  // invocations per group, whose sums are added first
const int kMaxSamples = kUnsharpSegment + kUnsharpMaxKernel - 1;

// Prefix sums: for each sample, the sum of the samples to its left; the last element is the sum of all samples. Then
// the sums of each invocation's part, and of each group of invocations.
shared uint high_before[kMaxSamples + 1], low_before[kMaxSamples + 1];
shared uint high_part[kInvocations], low_part[kInvocations];
shared uint high_group[kInvocations / kGroup], low_group[kInvocations / kGroup];

// Returns the words of the sample in column x of row y; outside the picture by the border mode.
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
  int part_size = (samples + kInvocations - 1) / kInvocations;

  // Adjacent invocations load adjacent samples. After that, each invocation sums a contiguous part of them.
  for (int k = own; k < samples; k += kInvocations) {
    uvec2 words = sample_at(left + C.first_column + k, y);
    high_before[k] = words.x;
    low_before[k] = words.y;
  }
  barrier();
  int begin = min(own * part_size, samples), end = min(begin + part_size, samples);
  uint high = 0u, low = 0u;
  for (int k = begin; k < end; ++k) {
    uint next_high = high + high_before[k], next_low = low + low_before[k];
    high_before[k] = high;
    low_before[k] = low;
    high = next_high;
    low = next_low;
  }
  high_part[own] = high;
  low_part[own] = low;
  barrier();
  if (own < kInvocations / kGroup) {
    uint group_high = 0u, group_low = 0u;
    for (int k = own * kGroup; k < (own + 1) * kGroup; ++k) {
      group_high += high_part[k];
      group_low += low_part[k];
    }
    high_group[own] = group_high;
    low_group[own] = group_low;
  }
  barrier();
  uint high_left = 0u, low_left = 0u;  // sums of all parts to the left of this one
  for (int k = 0; k < own / kGroup; ++k) {
    high_left += high_group[k];
    low_left += low_group[k];
  }
  for (int k = own / kGroup * kGroup; k < own; ++k) {
    high_left += high_part[k];
    low_left += low_part[k];
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
  // The differences are correct even if the words have overflowed.
  for (int k = own; k < pixels; k += kInvocations) {
    int at = y * F.stride + left + k;
    unsharp_row_high_plane().at[at] = high_before[k + window] - high_before[k];
    unsharp_row_low_plane().at[at] = low_before[k + window] - low_before[k];
  }
}
