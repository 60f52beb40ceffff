// Constants of the filters that soften shadows, for all devices. Shared by C++ and GLSL.
#ifndef UMBRAGE_DEVICES_SHARED_SOFTEN_H
#define UMBRAGE_DEVICES_SHARED_SOFTEN_H

const int kSoftenBlock = 4;  // pixels; each pixel of a block traces its shadow rays to other points on the light
// Min and max half width of the filter, pixels; the min is that of the first filter.
const float kSoftenMin = 2.0f, kSoftenMax = 14.0f;
const int kSoftenReachBlocks = 4;  // reach of the widest filter, blocks
// Half width of the second filter as a fraction of the radius of a penumbra. At the ends of a penumbra the filter
// changes the shadow by 0.12 * kSoftenFraction^1.5.
const float kSoftenFraction = 0.2f;

struct SoftenConstants {
  int dx, dy;  // direction: (1, 0) along a row, (0, 1) along a column
  int second;  // 1: the second filter
};

#endif
