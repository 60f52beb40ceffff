// SSIM: the structural similarity of two pictures [Wang et al. 2004].
#pragma once
#include "core/image.h"
#include "reference/metrics.h"

namespace umbrage {

/// The similarity around each covered pixel, from -1 to 1, averaged over the planes; 1 at background. Windows hold
/// covered pixels only: neither the background nor what lies outside the frame counts.
Plane ssim_map(const Image& picture, const Image& truth, const ClassMap& classes);

}  // namespace umbrage
