// Metering: the exposure that suits a picture, from how bright the surfaces in view are.
#pragma once
#include "core/device.h"

namespace umbrage {

/// Stops to add. The brightest surfaces, highlights left aside, are brought towards kMeteredWhite, though only so far:
/// what is dark is to look dark. 0 where nothing is in view. Reads `lit`, linear, and `depth`.
Result<float> metered_stops(Device& device, const Frame& frame);

inline constexpr float kMeteredWhite = 0.72f;

}  // namespace umbrage
