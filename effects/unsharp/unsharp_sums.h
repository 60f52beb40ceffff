// What the steps of `unsharp` on a GPU agree on. GLSL and C++ include it.
#ifndef UMBRAGE_EFFECTS_UNSHARP_SUMS_H
#define UMBRAGE_EFFECTS_UNSHARP_SUMS_H

const int kUnsharpSegment = 256;                              // pixels of a row that one workgroup sums
const int kUnsharpStripWidth = 64, kUnsharpStripHeight = 64;  // pixels that one workgroup sums down columns
// A window smaller than this is summed as soon sample by sample, where there is a threshold.
const int kUnsharpLeastBlocks = 12;

#endif
