// Occlusion, and with LIGHT the outgoing light of the occluders, which the dispatch `sent` has written.
// KERNEL bitmask_occlusion: LAYERS=0 BENT=0 LIGHT=0
// KERNEL bitmask_layers: LAYERS=1 BENT=0 LIGHT=0
// KERNEL bitmask_bent: LAYERS=1 BENT=1 LIGHT=0
// KERNEL bitmask_bleeding: LAYERS=1 BENT=0 LIGHT=1
#include "effects/bitmask/bitmask.kernel.h"

FN void bitmask_gather_pixel(Int px, Int py) { gather(px, py); }
