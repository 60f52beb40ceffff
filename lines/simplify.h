// Simplification of polylines.
#pragma once
#include <vector>

#include "core/lines.h"

namespace umbrage {

/// Returns the polyline without those points whose removal moves it by less than 1/20 of a pixel and changes its width
/// by less than 1/10 of a pixel.
std::vector<LinePoint> simplified(const std::vector<LinePoint>& points);

}  // namespace umbrage
