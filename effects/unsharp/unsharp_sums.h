// Constants of the steps of `unsharp` on a GPU. Shared by C++ and GLSL.
#ifndef UMBRAGE_EFFECTS_UNSHARP_SUMS_H
#define UMBRAGE_EFFECTS_UNSHARP_SUMS_H

const int kUnsharpSegment = 256;                              // pixels of a row per workgroup
const int kUnsharpStripWidth = 64, kUnsharpStripHeight = 64;  // pixels per workgroup that sums down columns
// Min width of a window, in pixels, at which summing by blocks is faster than sample by sample.
const int kUnsharpMinBlocks = 12;

#endif
