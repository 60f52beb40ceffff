// Soft shadows without their grain, on the CPU: where and in which order the passes of devices/shared/soften_passes.h
// run.
#pragma once
#include <span>

#include "core/band.h"
#include "core/gbuffer.h"
#include "core/image.h"
#include "devices/shared/soften.h"

namespace umbrage {

/// The radius of one light's penumbrae along a row and along a column, in pixels, of the narrowest in each block of 4 x
/// 4 pixels; infinite where nothing stands in the light's way. Block (i, j) stands at (i, j).
struct PenumbraRadii {
  int light = 0;
  Plane across, down;  ///< as wide as the picture, so that rows start as far apart
};

/// Blocks of 4 x 4 pixels in so many pixels.
int soften_blocks(int pixels);

/// Rows from which a softened shadow comes, above and below: the second filter reads kSoftenBlocks - 1 blocks, and what
/// is there hangs on penumbrae kSoftenBlocks farther.
inline constexpr int kSoftenMargin = (2 * kSoftenBlocks - 1) * kSoftenBlock;

/// Averages the shadows of these lights in the first layer along surfaces: over the 4 x 4 pixels around, then, where
/// penumbrae are wide, over up to 28 x 28, a fifth of their width. Where all around is alike nothing changes. Uses all
/// threads of the calling task arena; the result does not depend on their number. `scalar`: by the plain form of the
/// kernels. The image holds these rows of the picture, from a multiple of 4 on; within kSoftenMargin of where they end
/// inside the picture shadows are then no good.
void soften_shadows(const PictureInfo& info, const Rows& rows, std::span<const PenumbraRadii> radii, bool scalar,
                    Image& image);

}  // namespace umbrage
