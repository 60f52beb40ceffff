// Simplification of polylines.
#pragma once
#include <vector>

#include "core/lines.h"

namespace umbrage {

/// Returns the polyline without the points whose removal moves it by less than a twentieth of a pixel.
std::vector<LinePoint> simplified(const std::vector<LinePoint>& points);

}  // namespace umbrage
