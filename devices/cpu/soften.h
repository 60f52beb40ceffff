// Filtering of soft shadows on the CPU: runs the passes of devices/shared/soften_dispatches.h where they are needed.
#pragma once
#include <span>

#include "core/gbuffer.h"
#include "core/image.h"
#include "core/strip.h"
#include "devices/shared/soften.h"

namespace umbrage {

/// The radius of one light's penumbra along a row and along a column, pixels: that of the narrowest penumbra in each
/// block of 4 x 4 pixels; infinite where nothing blocks the light. Block (i, j) is at (i, j).
struct PenumbraRadii {
  int light = 0;
  Plane across, down;  ///< as wide as the picture, so that the strides match
};

/// Returns the number of blocks of 4 x 4 pixels that cover this many pixels.
int soften_blocks(int pixels);

/// Rows above and below that a softened shadow depends on: the second filter reads kSoftenReachBlocks - 1 blocks, and
/// its width depends on penumbrae up to kSoftenReachBlocks farther away.
inline constexpr int kSoftenMargin = (2 * kSoftenReachBlocks - 1) * kSoftenBlock;

/// Averages the shadows of these lights in the first layer along surfaces: over the 4 x 4 pixels around, then, where
/// penumbrae are wide, over up to 28 x 28, a fifth of their width. Uniform neighbourhoods do not change. Uses all
/// threads of the calling task arena; the result does not depend on their number. `scalar`: use the scalar form of the
/// kernels. The image holds `rows` of the picture, which start at a multiple of 4; within kSoftenMargin of a strip's
/// end inside the picture shadows are invalid afterwards.
void soften_shadows(const PictureInfo& info, const Rows& rows, std::span<const PenumbraRadii> radii, bool scalar,
                    Image& image);

}  // namespace umbrage
