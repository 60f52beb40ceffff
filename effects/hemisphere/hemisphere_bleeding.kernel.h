// Occlusion, and the light that occluders send, as pass hemisphere_sent wrote it.
IN_LAYERS_REAL(depth)
IN_VECTOR(normal)
IN_LAYERS_REAL(hemisphere_facing)
IN_LAYERS_REAL(hemisphere_sum)
IN_LAYERS_REAL(hemisphere_shares)
OUT_REAL(ao)
OUT_COLOR(indirect)

#include "effects/hemisphere/hemisphere_packed.kernel.h"

CONST bool kGathersLight = true;
FN Vec3 normal_of(int layer, Int place) { return unpacked_normal(read_hemisphere_facing_of(layer, place)); }
FN Vec3 sent_of(int layer, Int place) {
  return unpacked_light(read_hemisphere_sum_of(layer, place), read_hemisphere_shares_of(layer, place));
}
FN void store_light(Vec3 light) { store_indirect(light); }
#include "effects/hemisphere/hemisphere.kernel.h"

FN void hemisphere_bleeding_pixel(Int px, Int py) { gather(px, py); }
