// Occlusion, and the light from occluders: their outgoing light, which the dispatch `sent` has written.
IN_LAYERS_REAL(depth)
IN_VECTOR(normal)
OUT_REAL(ao)

CONST bool kGathersLight = true;
#include "effects/hemisphere/hemisphere_light.kernel.h"

#include "effects/hemisphere/hemisphere.kernel.h"

FN void hemisphere_bleeding_pixel(Int px, Int py) { gather(px, py); }
