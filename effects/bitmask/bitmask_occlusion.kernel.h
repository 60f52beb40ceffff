// Occlusion only, by occluders in the first depth layer.
#include "effects/bitmask/bitmask_no_light.kernel.h"
#include "effects/bitmask/bitmask_not_bent.kernel.h"
#include "effects/bitmask/bitmask_one_layer.kernel.h"

#include "effects/bitmask/bitmask.kernel.h"

FN void bitmask_occlusion_pixel(Int px, Int py) { gather(px, py); }
