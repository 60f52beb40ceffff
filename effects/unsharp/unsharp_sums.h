// Constants shared by the steps of `unsharp` on a GPU. Included by GLSL and C++.
#ifndef UMBRAGE_EFFECTS_UNSHARP_SUMS_H
#define UMBRAGE_EFFECTS_UNSHARP_SUMS_H

const int kUnsharpSegment = 256;                              // pixels of a row per workgroup
const int kUnsharpStripWidth = 64, kUnsharpStripHeight = 64;  // pixels per workgroup that sums down columns
// With a threshold, a window smaller than this is summed as fast sample by sample.
const int kUnsharpMinBlocks = 12;

#endif
