// The lines of a drawn picture as curves. The effects `outline`, `hidden` and `hatching` trace them from planes that
// remain in the frame. Therefore the lines can be traced again after drawing.
#pragma once
#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "core/lines.h"
#include "renderer/line_parameters.h"
#include "renderer/recipe.h"

namespace umbrage {

/// Returns the parameters of those of these effects that draw lines that are curves. `subject` is the start of the
/// error message, such as "the look 'ao' draws". Errors: kUsage if there are no such lines.
Result<LineParameters> line_parameters(std::string_view subject, std::span<const std::string_view> effects,
                                       const EffectSettings& settings);
/// Does the same for a recipe's look. Averaged pictures have such lines, too: they are drawn once, over the average.
Result<LineParameters> line_parameters(const Recipe& recipe);
/// Returns the same, or empty parameters if there are no such lines.
LineParameters line_parameters_or_none(const Recipe& recipe);

/// Returns the planes from which these lines of a picture with this number of layers are traced.
std::vector<std::string_view> edge_planes(const LineParameters& params, int layers);

/// Traces the lines of a picture from its edge_planes, which include the guard band. Points are in pixels of the
/// picture without the guard band; lines entirely outside of the picture are left out. Uses `threads` threads; the
/// result does not depend on their number.
Lines traced_lines(const PictureInfo& info, const Image& planes, const LineParameters& params, int threads);

/// Traces the lines of a frame on which the effects have run. Errors: those of Device::download.
Result<Lines> traced_lines(Device& device, const Frame& frame, const LineParameters& params);

/// Return the sRGB-encoded colour of the lines, and their opacity: those of `outline`, which hatching has too.
std::array<float, 3> line_color(const LineParameters& params);
float line_opacity(const LineParameters& params);

}  // namespace umbrage
