// Last dispatch of `antialias`: mixes `beauty` by the same areas as the picture. Its light is linear and premultiplied.
IN_COLOR(antialias_beauty)
IN_ALPHA(antialias_beauty)
OUT_COLOR(beauty)
OUT_ALPHA(beauty)
#include "effects/antialias/antialias_cover.kernel.h"

FN void antialias_beauty_pixel(Int px, Int py) {
  Cover c = cover();
  store_beauty(near_antialias_beauty(0, 0) * c.own + near_antialias_beauty(-1, 0) * c.left +
               near_antialias_beauty(1, 0) * c.right + near_antialias_beauty(0, -1) * c.above +
               near_antialias_beauty(0, 1) * c.below);
  store_beauty_alpha(near_antialias_beauty_a(0, 0) * c.own + near_antialias_beauty_a(-1, 0) * c.left +
                     near_antialias_beauty_a(1, 0) * c.right + near_antialias_beauty_a(0, -1) * c.above +
                     near_antialias_beauty_a(0, 1) * c.below);
}
