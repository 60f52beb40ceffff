// For kernels that gather light: functions that read the normal and the outgoing light of a pixel in a layer, which the
// dispatch `sent` has written, and that store the gathered light. With LIGHT=0 there is none.
#include "effects/hemisphere/hemisphere_packed.kernel.h"

IN_LAYERS_REAL_IF(LIGHT, hemisphere_facing)
IN_LAYERS_REAL_IF(LIGHT, hemisphere_sum)
IN_LAYERS_REAL_IF(LIGHT, hemisphere_shares)
OUT_COLOR_IF(LIGHT, light, indirect)

FN Vec3 normal_of(int layer, Int place) { return unpacked_normal(read_hemisphere_facing_of(layer, place)); }
FN Vec3 outgoing_light_of(int layer, Int place) {
  return unpacked_light(read_hemisphere_sum_of(layer, place), read_hemisphere_shares_of(layer, place));
}
CONST bool kLight = LIGHT == 1;
