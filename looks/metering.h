// Metering: the exposure that suits a picture, from how bright the surfaces in view are.
#pragma once
#include "core/device.h"

namespace umbrage {

/// Stops that bring white which is turned to the light to about 1: 0 but for a light that came with a file.
float usual_stops(const PictureInfo& info);

/// Stops to add. From those of usual_stops on: the brightest surfaces, highlights left aside, are brought towards
/// kMeteredWhite, or beyond by up to a stop where most of the picture is far darker than they are and its middle, the
/// geometric mean, below kMeteredGrey; though only so far: what is dark is to look dark. Those alone where nothing is
/// in view. Reads `lit`, linear, and `depth`.
Result<float> metered_stops(Device& device, const Frame& frame);

inline constexpr float kMeteredWhite = 0.72f;
inline constexpr float kMeteredGrey = 0.2f;

}  // namespace umbrage
