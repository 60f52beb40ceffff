// Marked samples: an averaged picture whose samples beyond the first are drawn only at the pixels that the first one
// marks, because edges are near: of objects, creases, textures and hard shadows. Elsewhere all samples would be nearly
// equal, and the first one stands. Further samples borrow occlusion, indirect light and soft shadows from the first,
// since these vary slowly along a surface: see effects/resample. Internal to renderer/.
#pragma once
#include "renderer/accumulation.h"
#include "renderer/plan.h"

namespace umbrage {

/// Returns whether a recipe's samples beyond the first are drawn at marked pixels only. Not if effects besides the
/// technique and its filters read neighbouring pixels, if a sky is shown, which has edges of its own, or with a
/// technique whose noise the average of all pixels is to reduce: all but those that filter themselves.
bool draws_marked_samples(const Recipe& recipe);

/// Returns whether the renderer sets this parameter of `resample` for each sample.
bool follows_from_samples(std::string_view parameter);

/// Sets the plan to a sample that is drawn at marked pixels and returns its camera.
Camera begin_marked(Plan& plan, int sample);

/// Captures a sample: at the pixels that `first` marks, or all pixels if it is null. In the latter case marks the
/// pixels for further samples if the plan has any.
Result<Frame> capture_sample(Device& device, const Plan& plan, const Camera& camera, const Frame* first,
                             const ProgressMonitor& monitor);

/// Marks the pixels of a captured frame of sample 0.
Result<RunState> mark_pixels(Device& device, const Plan& plan, Frame& frame, const ProgressMonitor& monitor);

/// Returns by how many rows the margin of a strip, drawn as sample 0, is too small for its further samples.
int missing_rows_for_marked(const Device& device, const Plan& plan, const Frame& first);

/// Runs the look on a captured frame of a further sample. `run`: that of the plan, with the stops of the first sample.
Result<void> shade_marked(Device& device, const Plan& plan, LookRun run, const Frame& first, Frame& frame);

/// Returns a sum that begins with the drawn frame of sample 0, of which it has the marks.
Result<PictureSum> begin_sum(Device& device, const Plan& plan, const Frame& first);

/// Adds the frame of a further sample.
Result<void> add_marked(Device& device, const Plan& plan, const Frame& frame, PictureSum& total);

}  // namespace umbrage
