// Occlusion, and the light that occluders reflect, as dispatch `sent` wrote it.
IN_LAYERS_REAL(depth)
IN_VECTOR(normal)
OUT_REAL(ao)

CONST bool kGathersLight = true;
#include "effects/hemisphere/hemisphere_light.kernel.h"

#include "effects/hemisphere/hemisphere.kernel.h"

FN void hemisphere_bleeding_pixel(Int px, Int py) { gather(px, py); }
