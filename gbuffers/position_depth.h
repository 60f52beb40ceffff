// Depth computed from positions, for files without a usable depth layer.
#pragma once
#include <optional>

#include "gbuffers/camera_guess.h"
#include "gbuffers/conventions.h"
#include "gbuffers/depth_values.h"

namespace umbrage {

/// Sets how view depth follows from positions, and replaces the depths of the samples by it. Without a fit, positions
/// are in the world of the file's camera if that puts them before it, else relative to the camera.
void use_positions(const Samples& samples, const std::optional<ProjectionFit>& fit, const KnownCamera& known,
                   PositionConvention& position, DepthValues& values, DepthModel& model);

}  // namespace umbrage
