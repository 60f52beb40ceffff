// Averaged pictures: which planes are averaged, and the lines drawn over the average. Internal to renderer/.
#pragma once
#include <string>
#include <vector>

#include "renderer/accumulation.h"
#include "renderer/blend.h"
#include "renderer/plan.h"
#include "renderer/times.h"

namespace umbrage {

/// averaged_planes returns the planes that are averaged; averaged_picture returns those of the
/// picture, `color`, `beauty`, both or none; other_averaged_planes the others.
std::vector<std::string> averaged_planes(const Plan& plan);
std::vector<std::string> averaged_picture(const Plan& plan);
std::vector<std::string> other_averaged_planes(const Plan& plan);

/// Returns the planes of sample 0 from which `output` draws the lines.
std::vector<std::string> line_planes(const Plan& plan);

/// Returns the finished averaged picture, as planes color.r, .g, .b and .a or beauty.r and so on.
/// Takes their planes out of the sum. `lines`: the line_planes of sample 0. `info`: properties of a picture that has
/// the size of the sum.
Result<Image> finished_picture(Device& device, PictureSum& total, const Plan& plan, const Image& lines,
                               const PictureInfo& info);

/// Computes the finished colour and the other means, and stores them in `frame`, the frame of sample 0. Its lines are
/// joined with those of `blended`.
Result<void> finish_average(Device& device, PictureSum& total, const Plan& plan, const BlendedSample& blended,
                            Frame& frame);

}  // namespace umbrage
