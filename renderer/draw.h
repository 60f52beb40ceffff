// Draws a plan on a device.
#pragma once
#include <optional>

#include "renderer/plan.h"
#include "renderer/progressive.h"
#include "renderer/times.h"

namespace umbrage {

/// A drawn picture.
struct Drawn {
  Frame frame;
  std::optional<float> stops;  ///< exposure that metering added, in stops; for other pictures with the same exposure
};

/// Draws the scene for which the device is prepared: captures it and runs the look. `stops`: exposure of another
/// picture, used in place of metering. `more` asks for samples beyond those of the plan, which must then average
/// several; the progress stays at 1 meanwhile. Errors: kInterrupted; the errors of the device and of more.take_mean.
Result<Drawn> draw(Device& device, const Scene& scene, const Plan& plan, StageTimes& times,
                   const ProgressMonitor& monitor = {}, std::optional<float> stops = {}, const Continuation& more = {});

/// The captured planes of a plan before any effect has run, one frame for each of pictures_of.
using Captures = std::vector<Frame>;

/// Captures all pictures of a plan. The device has finished all work when this returns, so all errors of the device are
/// reported here. Errors: kInterrupted; the errors of the device.
Result<Captures> capture(Device& device, const Plan& plan, StageTimes& times, const ProgressMonitor& monitor = {});
/// Returns whether captures of one plan are valid for the other plan: the plans differ only in effects.
bool same_captures(const Plan& a, const Plan& b);
/// Draws from captures, which stay unchanged. The picture is bitwise identical to the picture that `draw` returns.
Result<Drawn> draw_captured(Device& device, const Scene& scene, const Plan& plan, const Captures& captures,
                            StageTimes& times, const ProgressMonitor& monitor = {}, std::optional<float> stops = {});

/// Plans and draws a scene that `complete_scene` has completed.
Result<Frame> draw(Device& device, const Scene& scene, const Recipe& recipe, StageTimes& times);

/// Makes a recipe, plans and draws; environment images are not read. Errors: kUsage; the errors of `draw`.
Result<Frame> draw(Device& device, const Scene& scene, const Request& request, StageTimes& times);

/// Returns a recipe from make_shading_recipe with its radius in scene units. If `info` of a G-buffer has no lights, a
/// look gets the default lights, placed relative to the camera as for a model without lights. Errors: kUsage for a
/// radius larger than the scene.
Result<Recipe> complete_shading(const Recipe& recipe, PictureInfo& info);

/// Shades a G-buffer of another renderer with a recipe from make_shading_recipe. Missing normals are reconstructed from
/// depth. `stops`: exposure of another picture, used in place of metering. Errors: kUsage for missing planes; those of
/// complete_shading; kInterrupted.
Result<Drawn> shade_planes(Device& device, GBuffer gbuffer, const Recipe& recipe, StageTimes& times,
                           const ProgressMonitor& monitor = {}, std::optional<float> stops = {});

/// Adds the environment image to a frame if the plan shows it as background.
Result<void> add_sky(Device& device, const Plan& plan, Frame& frame);

}  // namespace umbrage
