// Masks of pixels: grown by what reads around them, and extended to blocks. Internal to renderer/.
#pragma once
#include "core/image.h"
#include "core/strip.h"
#include "program/program.h"

namespace umbrage {

/// Returns 1 for the pixels that are above 0 or within this distance, across and down, of one that is, else 0.
Plane grown(const Plane& from, const Margin& by);

/// Returns the end of the block of pixels that has the row above this one. Pixels of a block are captured together.
int block_end(int row);

/// Returns a mask of all blocks that have a pixel of this one. Then a strip captures each block as a whole picture
/// does.
PixelMask with_whole_blocks(PixelMask mask);

/// Returns the rows of `within` at which a mask has pixels, extended to whole blocks. `within` begins with a block.
Rows rows_of(const PixelMask& mask, const Rows& within);

}  // namespace umbrage
