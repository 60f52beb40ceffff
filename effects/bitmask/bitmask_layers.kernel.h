// Occlusion only, by occluders in all depth layers.
#include "effects/bitmask/bitmask_all_layers.kernel.h"
#include "effects/bitmask/bitmask_no_light.kernel.h"
#include "effects/bitmask/bitmask_not_bent.kernel.h"

#include "effects/bitmask/bitmask.kernel.h"

FN void bitmask_layers_pixel(Int px, Int py) { gather(px, py); }
