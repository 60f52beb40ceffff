// Writes the outgoing light of each pixel, with the kernel of `hemisphere`.
#include "effects/hemisphere/hemisphere_sent.kernel.h"

FN void ssdo_sent_pixel(Int px, Int py) { hemisphere_sent_pixel(px, py); }
