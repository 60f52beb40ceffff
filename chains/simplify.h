// Simplification of polylines.
#pragma once
#include <vector>

#include "core/strokes.h"

namespace umbrage {

/// Returns the polyline without those points whose removal moves it by less than 1/20 of a pixel and changes its width
/// by less than 1/10 of a pixel.
std::vector<StrokePoint> simplified(const std::vector<StrokePoint>& points);

}  // namespace umbrage
