// The values that count in a comparison: values of covered pixels, with 0 in place of NaN and infinity.
#pragma once
#include <cmath>

#include "reference/metrics.h"

namespace umbrage {

inline constexpr int kRowsPerTask = 16;  ///< enough to outweigh the scratch memory of a task

inline bool is_counted(PixelClass pixel) { return pixel != PixelClass::kBackground; }

inline float finite_or_zero(float value) { return std::isfinite(value) ? value : 0.0f; }

/// Copies a row of a plane: `background` where there is no surface, 0 where the value is not finite.
inline void counted_row(const float* values, const PixelClass* classes, int width, float background, float* out) {
  for (int x = 0; x < width; ++x) out[x] = is_counted(classes[x]) ? finite_or_zero(values[x]) : background;
}

}  // namespace umbrage
