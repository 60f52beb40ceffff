// Conversion of a Length to an absolute number. Not in core/length.h, because GLSL includes that file too.
#pragma once
#include "core/length.h"

namespace umbrage {

/// Returns the absolute length. `whole`: the length that is 100%, in the unit of absolute lengths.
inline float absolute_length(const Length& length, float whole) {
  return length.relative != 0 ? length.value / 100.0f * whole : length.value;
}

}  // namespace umbrage
