// Occlusion, the light of open directions, and that of occluders, which the dispatch `sent` has written.
IN_LAYERS_REAL(depth)
IN_VECTOR(normal)
OUT_REAL(ao)

CONST bool kLight = true;
#include "effects/hemisphere/hemisphere_light.kernel.h"

#include "effects/ssdo/ssdo.kernel.h"

FN void ssdo_light_pixel(Int px, Int py) { gather(px, py); }
