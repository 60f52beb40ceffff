// Shades a G-buffer of another renderer as a whole picture.
#pragma once
#include <optional>

#include "renderer/draw.h"

namespace umbrage {

/// Returns a recipe from make_shading_recipe with its radius in scene units. If `info` of a G-buffer has no lights, a
/// look gets the default lights, placed relative to the camera as for a model without lights. Errors: kUsage for a
/// radius larger than the scene.
Result<Recipe> complete_shading(const Recipe& recipe, PictureInfo& info);

/// Shades a G-buffer of another renderer with a recipe from make_shading_recipe. Missing normals are reconstructed from
/// depth. `stops`: exposure of another picture, used in place of metering. Errors: kUsage for missing planes; those of
/// complete_shading; kInterrupted.
Result<Drawn> shade_planes(Device& device, GBuffer gbuffer, const Recipe& recipe, StageTimes& times,
                           const ProgressMonitor& monitor = {}, std::optional<float> stops = {});

}  // namespace umbrage
