// Exposure: metering of a small picture before the picture itself. Internal to renderer/.
#pragma once
#include <optional>

#include "renderer/drawing.h"

namespace umbrage {

inline constexpr int kMeteredSide = 192;  ///< max. side of the small picture, pixels

/// Returns whether the exposure of a plan's picture is metered on a picture.
bool meters_picture(const Plan& plan);

/// Returns the stops that metering adds to the exposure; those of drawing.run if it has any. They are metered on a
/// small picture of Plan::metered, or of the plan's own view, in which blended surfaces are opaque. Empty if nothing is
/// metered on a picture. Errors: kInterrupted; the errors of the device.
Result<std::optional<float>> metered_exposure(const Drawing& drawing, const Plan& plan);

}  // namespace umbrage
