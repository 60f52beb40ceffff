// Conversion of a Length to an absolute number. Separate from core/length.h, which GLSL reads too.
#pragma once
#include "core/length.h"

namespace umbrage {

/// Returns the length in the unit of `whole`, which percentages refer to.
inline float absolute_length(const Length& length, float whole) {
  return length.relative != 0 ? length.value / 100.0f * whole : length.value;
}

}  // namespace umbrage
