// A picture of averaged frames: what of them is averaged, and the lines that lie over the average. For renderer/ alone.
#pragma once
#include <string>
#include <vector>

#include "renderer/accumulation.h"
#include "renderer/plan.h"
#include "renderer/times.h"

namespace umbrage {

/// The planes of a frame that are averaged; and those of them that are no colour.
std::vector<std::string> averaged_planes(const Plan& plan);
std::vector<std::string> also_averaged(const Plan& plan);

/// Draws the lines that lie over averaged frames, on frame 0: on others nothing.
Result<Progression> draw_lines(Device& device, const Plan& plan, Frame& frame, const ProgressMonitor& monitor,
                               StageTimes& times);

/// The planes of frame 0 that `output` draws them from.
std::vector<std::string> line_planes(const Plan& plan);

/// The finished colour of averaged frames, as planes color.r, .g, .b and .a. `lines`: their line_planes. `info`: of a
/// picture of the sum's size.
Result<Image> finished_color(Device& device, const PictureSum& total, const Plan& plan, const Image& lines,
                             const PictureInfo& info);

/// Makes the finished picture of averaged frames, and puts it and what else was averaged into frame 0.
Result<void> finish_average(Device& device, const PictureSum& total, const Plan& plan, Frame& frame);

}  // namespace umbrage
