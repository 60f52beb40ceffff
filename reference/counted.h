// What counts in a comparison: the covered pixels of a plane, with numbers in place of what is none.
#pragma once
#include <cmath>

#include "reference/metrics.h"

namespace umbrage {

inline bool is_counted(PixelClass pixel) { return pixel != PixelClass::kBackground; }

inline float finite_or_zero(float value) { return std::isfinite(value) ? value : 0.0f; }

/// One row of a plane as it counts: `background` where there is no surface, 0 where there is no number.
inline void counted_row(const float* values, const PixelClass* classes, int width, float background, float* out) {
  for (int x = 0; x < width; ++x) out[x] = is_counted(classes[x]) ? finite_or_zero(values[x]) : background;
}

}  // namespace umbrage
