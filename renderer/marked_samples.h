// Marked samples: an averaged picture whose samples beyond the first are drawn only at the pixels that the first one
// marks, because edges are near: of objects, creases, textures and hard shadows. Elsewhere all samples would be nearly
// equal, and the first one stands. Further samples borrow occlusion, indirect light and soft shadows from the first,
// since these vary slowly along a surface: see effects/resample. Of blended surfaces, each sample draws the picture in
// front only where they show. Internal to renderer/.
#pragma once
#include <string_view>

#include "renderer/average.h"
#include "renderer/drawing.h"
#include "renderer/plan.h"

namespace umbrage {

/// Returns whether a recipe's samples beyond the first are drawn at marked pixels only. Not if effects besides the
/// technique and its filters read neighbouring pixels, if a sky is shown, which has edges of its own, or with a
/// technique whose noise the average of all pixels is to reduce: all but those that filter themselves, unless further
/// samples are for edges alone.
bool draws_marked_samples(const Recipe& recipe);

/// Returns whether the renderer sets this parameter of `resample` for each sample.
bool follows_from_samples(std::string_view parameter);

/// Returns the step that marks the pixels of the first sample. `info`: that of its picture.
EffectStep marking_step(const Plan& plan, const PictureInfo& info);
/// Adds to `after` the margins around its own pixels at which the first sample needs planes for further samples.
void add_margins_for_further(const Plan& plan, const PictureInfo& info, Margins& after);

/// Returns the average of a plan's samples, or of the strip of them to which the plan is set. `behind`: the first
/// sample without blended surfaces, captured by PictureDrawing::capture, on which the look has run; drawing.run has its
/// stops. Its averaged picture is released.
Result<Average> marked_average(const PictureDrawing& drawing, const Plan& plan, Frame& behind);

}  // namespace umbrage
