// `unsharp` with a threshold, on a GPU: min, max and sum of 16 x 16 samples, from the 8 x 8 ones of
// unsharp_blocks8.comp. The sum may overflow. The next step is unsharp_blocks.comp.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/unsharp/unsharp.h"
UMBRAGE_CONSTANTS(UnsharpConstants)

IN_REAL(unsharp_least8)
IN_REAL(unsharp_greatest8)
PLANE(UintPlane, unsharp_sum8, 0)
OUT_REAL(unsharp_least16)
OUT_REAL(unsharp_greatest16)
PLANE(UintPlane, unsharp_sum16, 0)

void blocks16_pixel(int px, int py) {
  float least = near_unsharp_least8(0, 0), greatest = near_unsharp_greatest8(0, 0);
  uint sum = 0u;
  for (int j = 0; j < 16; j += 8)
    for (int i = 0; i < 16; i += 8) {
      int block = index_of(px + i, py + j);
      least = min(least, read_unsharp_least8(block));
      greatest = max(greatest, read_unsharp_greatest8(block));
      sum += unsharp_sum8_plane().at[block];
    }
  store_unsharp_least16(least);
  store_unsharp_greatest16(greatest);
  unsharp_sum16_plane().at[index_of_own()] = sum;
}
UMBRAGE_MAIN(blocks16)
