// How soft shadows are filtered, on every device: what kernels read, shared by C++ and GLSL.
#ifndef UMBRAGE_DEVICES_SHARED_SOFTEN_H
#define UMBRAGE_DEVICES_SHARED_SOFTEN_H

const int kSoftenBlock = 4;  // pixels: a block's shadow rays go to as many places on the light as it has pixels
// Half of the filter's width, in pixels: at least that of the first filter.
const float kSoftenLeast = 2.0f, kSoftenMost = 14.0f;
const int kSoftenBlocks = 4;  // as many blocks away the widest filter has ended

struct SoftenConstants {
  int dx, dy;  // along a row or a column
  int second;  // 1: the second filter
};

#endif
