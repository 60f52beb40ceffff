// `unsharp` with a threshold, on a GPU, first step: min, max and sum of the 4 x 4 samples right and down of each
// sample. Blocks that extend past the picture have undefined values and are never read. The next step is
// unsharp_blocks8.comp.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/unsharp/unsharp.h"
UMBRAGE_CONSTANTS(UnsharpConstants)

IN_REAL(unsharp_depth)
OUT_REAL(unsharp_least4)
OUT_REAL(unsharp_greatest4)
PLANE(UintPlane, unsharp_sum4, 0)

void blocks4_pixel(int px, int py) {
  float least = near_unsharp_depth(0, 0), greatest = least;
  uint sum = 0u;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      float steps = near_unsharp_depth(i, j);
      least = min(least, steps);
      greatest = max(greatest, steps);
      sum += uint(int(max(steps, 0.0f)));
    }
  store_unsharp_least4(least);
  store_unsharp_greatest4(greatest);
  unsharp_sum4_plane().at[index_of_own()] = sum;
}
UMBRAGE_MAIN(blocks4)
