// The passes that soften shadows, on every device. Texts: soften.kernel.h, soften_reach.kernel.h.
#pragma once
#include "core/effect.h"
#include "devices/shared/soften.h"

namespace umbrage {

/// From `penumbra`, a penumbra's radius in pixels by block of 4 x 4 pixels, to `soften_reach`, half the width of the
/// second filter there. It runs over the blocks as if they were pixels.
const Pass& soften_reach_pass();

/// A filter along rows or columns, from `soften_from` to `soften_to`.
const Pass& soften_pass();

}  // namespace umbrage
