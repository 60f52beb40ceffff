// Outgoing light of each pixel: the same kernel as in `hemisphere`.
#include "effects/hemisphere/hemisphere_sent.kernel.h"

FN void bitmask_sent_pixel(Int px, Int py) { hemisphere_sent_pixel(px, py); }
