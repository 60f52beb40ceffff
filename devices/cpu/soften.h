// Filtering of soft shadows on the CPU: runs the dispatches of devices/shared/capture_info.h where shadows change.
#pragma once
#include <span>

#include "core/gbuffer.h"
#include "core/image.h"
#include "core/strip.h"
#include "devices/shared/soften.h"

namespace umbrage {

/// The radii of one light's penumbra along rows and along columns, pixels: for each block of 4 x 4 pixels that of its
/// narrowest penumbra; infinite where nothing blocks the light. Block (i, j) is pixel (i, j) of the planes.
struct PenumbraRadii {
  int light = 0;
  Plane across, down;  ///< as wide as the picture, so that their stride is that of its planes
};

/// Returns the number of blocks of 4 x 4 pixels that cover this many pixels.
int soften_blocks(int pixels);

/// Averages the shadows of these lights in the first layer over pixels of the same surface: first over 4 x 4 pixels,
/// then, where penumbrae are wide, over a fifth of their width, up to 28 x 28 pixels. Where all neighbours are equal,
/// shadows do not change. Uses all threads of the calling task arena; the result does not depend on their number.
/// `scalar`: use the scalar form of the kernels. The image contains `rows` of the picture, which start at a multiple of
/// 4. Where they begin or end inside the picture, kSoftenMargin rows of the shadows are invalid afterwards.
void soften_shadows(const PictureInfo& info, const Rows& rows, std::span<const PenumbraRadii> radii, bool scalar,
                    Image& image);

}  // namespace umbrage
