// SSIM: the structural similarity of two pictures [Wang et al. 2004].
#pragma once
#include "core/image.h"
#include "reference/metrics.h"

namespace umbrage {

/// Returns the similarity around each covered pixel, -1 to 1, averaged over the planes; 1 at background pixels. Windows
/// contain only covered pixels inside the picture.
Plane ssim_map(const Image& picture, const Image& truth, const ClassMap& classes);

}  // namespace umbrage
