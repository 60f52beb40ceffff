// Occlusion by occluders in all depth layers, and the mean unoccluded direction in view space.
#include "effects/bitmask/bitmask_all_layers.kernel.h"
#include "effects/bitmask/bitmask_no_light.kernel.h"

OUT_VECTOR(bent)
CONST bool kBent = true;
#include "effects/bitmask/bitmask.kernel.h"

FN void bitmask_bent_pixel(Int px, Int py) { gather(px, py); }
