// The dispatches that soften shadows, on every device. Kernels: soften.kernel.h, soften_reach.kernel.h.
#pragma once
#include "core/effect.h"
#include "devices/shared/soften.h"

namespace umbrage {

/// Returns the dispatch that computes `soften_reach`, half the width of the second filter, from `penumbra`, the radius
/// of the penumbra, both in pixels and with one value per block of 4 x 4 pixels. It runs over the blocks as if they
/// were pixels.
const Dispatch& soften_reach_dispatch();

/// Returns the dispatch that filters along rows or columns, from `soften_from` to `soften_to`.
const Dispatch& soften_dispatch();

}  // namespace umbrage
