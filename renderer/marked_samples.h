// Marked samples: an averaged picture whose samples beyond the first are drawn only at the pixels that the first one
// marks, because edges are near: of objects, creases, textures and hard shadows. Elsewhere all samples would be nearly
// equal, and the first one stands. Further samples borrow occlusion, indirect light and soft shadows from the first,
// since these vary slowly along a surface: see effects/resample. Of blended surfaces, each sample draws the picture in
// front only where they show. Internal to renderer/.
#pragma once
#include <functional>
#include <memory>
#include <optional>

#include "renderer/accumulation.h"
#include "renderer/blend.h"
#include "renderer/plan.h"

namespace umbrage {

/// Returns whether a recipe's samples beyond the first are drawn at marked pixels only. Not if effects besides the
/// technique and its filters read neighbouring pixels, if a sky is shown, which has edges of its own, or with a
/// technique whose noise the average of all pixels is to reduce: all but those that filter themselves.
bool draws_marked_samples(const Recipe& recipe);

/// Returns whether the renderer sets this parameter of `resample` for each sample.
bool follows_from_samples(std::string_view parameter);

/// Captures a picture of a plan that is set to it: Plan::capture with this camera. The frame may be an earlier capture.
using GetFrame = std::function<Result<Frame>(const Plan& plan, const Camera& camera)>;

using PixelMaskPtr = std::shared_ptr<const PixelMask>;

/// The first sample, whose frames have the planes that further samples borrow; of a strip, if the plan is of one.
struct FirstSample {
  Frame behind;                     ///< without blended surfaces
  Rows rows = {};                   ///< of the strip, or all
  std::optional<Frame> front = {};  ///< of blended surfaces, at pixels where they show; empty if none does
  Rows front_rows = {};             ///< rows of that frame
  PixelMaskPtr marks = {};          ///< the pixels that further samples draw
  PixelMaskPtr front_marks = {};    ///< those of them at which blended surfaces may show, in front_rows
};

/// Returns the step that marks the pixels of the first sample. `info`: that of its picture.
EffectStep marking_step(const Plan& plan, const PictureInfo& info);
/// Adds to `after` the margins around its own pixels at which the first sample needs planes for further samples.
void add_margins_for_further(const Plan& plan, const PictureInfo& info, Margins& after);

/// Returns the exposure that metering adds to a picture with blended surfaces, metered on a small picture that shows
/// them as if they were opaque, since what is behind them may be dark. Empty if nothing is metered so. `run`: that of
/// the plan.
Result<std::optional<float>> metered_with_blended(Device& device, const Plan& plan, const GetFrame& get, LookRun run);

/// Captures the first sample without blended surfaces and marks its pixels. The plan is set to it.
Result<Frame> capture_first(Device& device, const Plan& plan, const Camera& camera, const GetFrame& get,
                            const ProgressMonitor& monitor);
/// Completes the first sample: captures its blended surfaces and runs the look on them; without `run`, only captures
/// them. `behind`: as capture_first
/// returned it; the look may have run on it. `in_strips`: `get` captures anew, and can return strips. Earlier captures
/// have all pixels of blended surfaces, since settings that have changed since may reach farther.
Result<FirstSample> complete_first(Device& device, const Plan& plan, Frame behind, bool in_strips, const GetFrame& get,
                                   const LookRun* run);
/// Returns a sum that begins with the drawn first sample.
Result<PictureSum> begin_sum(Device& device, const Plan& plan, const FirstSample& first);

/// Sets the plan to a sample that is drawn at marked pixels and returns its camera.
Camera begin_marked(Plan& plan, int sample);
/// Draws a further sample and adds it to `total`; without `total`, only captures it. The plan is set to the sample, and
/// to the strip of it that is drawn. `run`: that of the plan, with the stops of the first sample.
Result<void> draw_marked(Device& device, const Plan& plan, const Camera& camera, const FirstSample& first,
                         const GetFrame& get, const LookRun& run, PictureSum* total);

}  // namespace umbrage
