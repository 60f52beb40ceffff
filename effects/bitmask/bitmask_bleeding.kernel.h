// Occlusion, and indirect light: the outgoing light of the occluders, which the dispatch `sent` has written.
#include "effects/bitmask/bitmask_all_layers.kernel.h"
#include "effects/bitmask/bitmask_not_bent.kernel.h"
#include "effects/hemisphere/hemisphere_light.kernel.h"
CONST bool kLight = true;

#include "effects/bitmask/bitmask.kernel.h"

FN void bitmask_bleeding_pixel(Int px, Int py) { gather(px, py); }
