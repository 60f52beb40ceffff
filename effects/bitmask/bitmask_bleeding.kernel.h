// Occlusion, and the light that occluders send, as pass `sent` wrote it.
IN_LAYERS_REAL(depth)
IN_VECTOR(normal)
IN_REAL(bitmask_mips)
IN_LAYERS_REAL(hemisphere_facing)
IN_LAYERS_REAL(hemisphere_sum)
IN_LAYERS_REAL(hemisphere_shares)
OUT_REAL(ao)
OUT_COLOR(indirect)

#include "effects/hemisphere/hemisphere_packed.kernel.h"

CONST bool kLayers = true;
FN Real depth_of(int layer, Int place) { return read_depth_of(layer, place); }
FN Real mip_of(Int place) { return read_bitmask_mips(place); }
CONST bool kLight = true;
FN Vec3 normal_of(int layer, Int place) { return unpacked_normal(read_hemisphere_facing_of(layer, place)); }
FN Vec3 sent_of(int layer, Int place) {
  return unpacked_light(read_hemisphere_sum_of(layer, place), read_hemisphere_shares_of(layer, place));
}
FN void store_light(Vec3 light) { store_indirect(light); }
CONST bool kBent = false;
FN void store_bent(Vec3 bent) {}
#include "effects/bitmask/bitmask.kernel.h"

FN void bitmask_bleeding_pixel(Int px, Int py) { gather(px, py); }
