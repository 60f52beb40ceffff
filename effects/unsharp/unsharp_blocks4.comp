// First step of `unsharp` with a threshold on a GPU: computes, for each sample as the upper left one, the min, max and
// sum of a block of 4 x 4 samples. Values of blocks that extend past the picture are undefined and never read. The next
// step is unsharp_blocks8.comp.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/unsharp/unsharp.h"
UMBRAGE_CONSTANTS(UnsharpConstants)

IN_REAL(unsharp_depth)
OUT_REAL(unsharp_min4)
OUT_REAL(unsharp_max4)
PLANE(UintPlane, unsharp_sum4)

void blocks4_pixel(int px, int py) {
  float min_value = near_unsharp_depth(0, 0), max_value = min_value;
  uint sum = 0u;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      float steps = near_unsharp_depth(i, j);
      min_value = min(min_value, steps);
      max_value = max(max_value, steps);
      sum += uint(int(max(steps, 0.0f)));
    }
  store_unsharp_min4(min_value);
  store_unsharp_max4(max_value);
  unsharp_sum4_plane().at[index_of_own()] = sum;
}
UMBRAGE_MAIN(blocks4)
