// Second step of `unsharp` with a threshold on a GPU: computes the min, max and sum of blocks of 8 x 8 samples from the
// blocks of unsharp_blocks4.comp. The next step is unsharp_blocks16.comp.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/unsharp/unsharp.h"
UMBRAGE_CONSTANTS(UnsharpConstants)

IN_REAL(unsharp_min4)
IN_REAL(unsharp_max4)
PLANE(UintPlane, unsharp_sum4)
OUT_REAL(unsharp_min8)
OUT_REAL(unsharp_max8)
PLANE(UintPlane, unsharp_sum8)

void blocks8_pixel(int px, int py) {
  float min_value = near_unsharp_min4(0, 0), max_value = near_unsharp_max4(0, 0);
  uint sum = 0u;
  for (int j = 0; j < 8; j += 4)
    for (int i = 0; i < 8; i += 4) {
      int block = index_of(px + i, py + j);
      min_value = min(min_value, read_unsharp_min4(block));
      max_value = max(max_value, read_unsharp_max4(block));
      sum += unsharp_sum4_plane().at[block];
    }
  store_unsharp_min8(min_value);
  store_unsharp_max8(max_value);
  unsharp_sum8_plane().at[index_of_own()] = sum;
}
UMBRAGE_MAIN(blocks8)
