// Third step of `unsharp` with a threshold on a GPU: computes the min, max and sum of blocks of 16 x 16 samples from
// the blocks of unsharp_blocks8.comp. The sum may overflow. The next step is unsharp_blocks.comp.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel/glsl.h"

#include "effects/unsharp/unsharp.h"
UMBRAGE_CONSTANTS(UnsharpConstants)

IN_REAL(unsharp_min8)
IN_REAL(unsharp_max8)
PLANE(UintPlane, unsharp_sum8)
OUT_REAL(unsharp_min16)
OUT_REAL(unsharp_max16)
PLANE(UintPlane, unsharp_sum16)

void blocks16_pixel(int px, int py) {
  float min_value = near_unsharp_min8(0, 0), max_value = near_unsharp_max8(0, 0);
  uint sum = 0u;
  for (int j = 0; j < 16; j += 8)
    for (int i = 0; i < 16; i += 8) {
      int block = index_of(px + i, py + j);
      min_value = min(min_value, read_unsharp_min8(block));
      max_value = max(max_value, read_unsharp_max8(block));
      sum += unsharp_sum8_plane().at[block];
    }
  store_unsharp_min16(min_value);
  store_unsharp_max16(max_value);
  unsharp_sum16_plane().at[index_of_own()] = sum;
}
UMBRAGE_MAIN(blocks16)
