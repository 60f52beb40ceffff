// PixelMask: a set of pixels of a picture. Captures and dispatches leave out the others.
#pragma once
#include "core/image.h"

namespace umbrage {

/// The pixels at which a plane is above 0.
struct PixelMask {
  Plane plane;        ///< full rows of the picture, guard band included
  int first_row = 0;  ///< row of the picture that is the plane's row 0

  bool at(int x, int y) const { return plane.row(y - first_row)[x] > 0.0f; }
  /// Returns whether the set has a pixel in [x0, x1) x [y0, y1).
  bool any(int x0, int x1, int y0, int y1) const {
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x)
        if (at(x, y)) return true;
    return false;
  }
};

}  // namespace umbrage
