// Polylines of fewer points.
#pragma once
#include <vector>

#include "core/lines.h"

namespace umbrage {

/// The points of a polyline without those that it hardly leaves when they go: by less than a twentieth of a pixel.
std::vector<LinePoint> simplified(const std::vector<LinePoint>& points);

}  // namespace umbrage
