// Constants of the filters of soft shadows, on every device. Shared by C++ and GLSL.
#ifndef UMBRAGE_DEVICES_SHARED_SOFTEN_H
#define UMBRAGE_DEVICES_SHARED_SOFTEN_H

const int kSoftenBlock = 4;  // pixels; the shadow rays of a block go to as many points on the light as it has pixels
// Min and max half width of the filter, pixels; the min is that of the first filter.
const float kSoftenMin = 2.0f, kSoftenMax = 14.0f;
const int kSoftenReachBlocks = 4;  // reach of the widest filter, blocks

struct SoftenConstants {
  int dx, dy;  // direction: (1, 0) along a row, (0, 1) along a column
  int second;  // 1: the second filter
};

#endif
