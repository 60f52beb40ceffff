// What a Length is, in the unit of its parameter. Apart from core/length.h, which GLSL reads, too.
#pragma once
#include "core/length.h"

namespace umbrage {

/// In the unit of `whole`, which is what a share is of.
inline float absolute_length(const Length& length, float whole) {
  return length.relative != 0 ? length.value / 100.0f * whole : length.value;
}

}  // namespace umbrage
