// The marked pixels of a picture, at which further samples are captured and shaded: see Device::capture_marked.
#pragma once
#include "core/image.h"

namespace umbrage {

/// The block of pixels that the CPU computes if one of them is marked: dispatches work in lanes of up to 16 pixels, and
/// the capture in packets of 4 x 4 rays. Blocks start at multiples of their size in the picture, also in strips.
inline constexpr int kMarkedWidth = 16, kMarkedHeight = 4;

/// The pixels where a plane is 1.
struct MarkedPixels {
  const Plane& marks;
  int first_row = 0;  ///< row of the picture that is the plane's row 0

  bool at(int x, int y) const { return marks.row(y - first_row)[x] > 0.0f; }
  /// Returns whether a pixel of [x0, x1) x [y0, y1) is marked.
  bool any(int x0, int x1, int y0, int y1) const {
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x)
        if (at(x, y)) return true;
    return false;
  }
};

}  // namespace umbrage
