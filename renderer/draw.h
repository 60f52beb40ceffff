// Drawing: a plan becomes a picture on a device.
#pragma once
#include <optional>

#include "renderer/plan.h"
#include "renderer/times.h"

namespace umbrage {

struct Drawn {
  Frame frame;
  std::optional<float> stops;  ///< what metering added to the exposure, for pictures that belong together
};

/// Draws a scene that the device was prepared with: captures, runs the look. `stops`:
/// of another picture, in place of metering. Errors: kInterrupted; those of the device.
Result<Drawn> draw(Device& device, const Scene& scene, const Plan& plan, StageTimes& times,
                   const ProgressMonitor& monitor = {}, std::optional<float> stops = {});

/// What a plan's camera sees before any effect has run: of each sample a frame. Once they are handed out the device has
/// drawn them: what goes wrong with that is told here.
using Captures = std::vector<Frame>;
Result<Captures> capture(Device& device, const Plan& plan, StageTimes& times, const ProgressMonitor& monitor = {});
/// Whether captures of the one plan serve the other: then they differ in effects alone.
bool same_captures(const Plan& a, const Plan& b);
/// Draws from captures, which stay as they are. The picture is that of `draw`, to the bit.
Result<Drawn> draw_captured(Device& device, const Scene& scene, const Plan& plan, const Captures& captures,
                            StageTimes& times, const ProgressMonitor& monitor = {}, std::optional<float> stops = {});

/// Plans and draws a furnished scene.
Result<Frame> draw(Device& device, const Scene& scene, const Recipe& recipe, StageTimes& times);

/// Makes a recipe, plans and draws: a picture without an image around the scene. Errors: kUsage, too.
Result<Frame> draw(Device& device, const Scene& scene, const Request& request, StageTimes& times);

/// Shades what another renderer drew by a recipe of its request. Without normals they are made of the depth. Where
/// gbuffer.info has no lights a look gets some, as they stand to the camera of a model without lights. Errors: kUsage
/// for planes that are missing and a radius larger than the scene; kInterrupted.
Result<Frame> shade_planes(Device& device, GBuffer gbuffer, const Recipe& recipe, StageTimes& times,
                           const ProgressMonitor& monitor = {});

/// Adds the image around the scene to a frame, where it is to be seen.
Result<void> add_sky(Device& device, const Plan& plan, Frame& frame);

}  // namespace umbrage
