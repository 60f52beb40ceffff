// Edges between neighbouring pixels as outline_edges stores them: whole numbers below 2^21. Shared by C++ and GLSL.
//
//   bits 0-1    kind: 0 no edge, kOutlineCrease, kOutlineDepth, kOutlineId
//   bits 2-8    strength, in units of its threshold, times 31
//   bits 9-15   place, from the one pixel's centre to the other's, times 127
//   bits 16-20  how many pairs from this one to the one that it lies in, plus kOutlineMaxWindow
#ifndef UMBRAGE_EFFECTS_OUTLINE_CODE_H
#define UMBRAGE_EFFECTS_OUTLINE_CODE_H

const int kOutlineCrease = 1, kOutlineDepth = 2, kOutlineId = 3;
const float kOutlineMinStrength = 0.5f;  // what is less is no edge
const float kOutlineMaxStrength = 4.0f;
const int kOutlineMaxWindow = 14;  // pixels, half a crease's widest window

#endif
