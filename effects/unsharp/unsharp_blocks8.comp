// `unsharp` with a threshold, on a GPU: min, max and sum of 8 x 8 samples, from the 4 x 4 ones of unsharp_blocks4.comp.
// The next step is unsharp_blocks16.comp.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/unsharp/unsharp.h"
UMBRAGE_CONSTANTS(UnsharpConstants)

IN_REAL(unsharp_least4)
IN_REAL(unsharp_greatest4)
PLANE(UintPlane, unsharp_sum4, 0)
OUT_REAL(unsharp_least8)
OUT_REAL(unsharp_greatest8)
PLANE(UintPlane, unsharp_sum8, 0)

void blocks8_pixel(int px, int py) {
  float least = near_unsharp_least4(0, 0), greatest = near_unsharp_greatest4(0, 0);
  uint sum = 0u;
  for (int j = 0; j < 8; j += 4)
    for (int i = 0; i < 8; i += 4) {
      int block = index_of(px + i, py + j);
      least = min(least, read_unsharp_least4(block));
      greatest = max(greatest, read_unsharp_greatest4(block));
      sum += unsharp_sum4_plane().at[block];
    }
  store_unsharp_least8(least);
  store_unsharp_greatest8(greatest);
  unsharp_sum8_plane().at[index_of_own()] = sum;
}
UMBRAGE_MAIN(blocks8)
