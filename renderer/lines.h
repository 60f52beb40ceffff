// The lines of a drawn picture as curves. The effect `outline` traces them from planes that remain in the frame and are
// identical on all devices. Therefore the lines can be traced again after drawing.
#pragma once
#include <array>
#include <span>
#include <string_view>

#include "core/lines.h"
#include "renderer/recipe.h"

namespace umbrage {

/// Returns the parameters of `outline` if these effects draw lines that are curves. `subject` is the start of the error
/// message, such as "the look 'ao' draws". Errors: kUsage if there are no such lines.
Result<ParameterBytes> line_parameters(std::string_view subject, std::span<const std::string_view> effects,
                                       const EffectSettings& settings);
/// Does the same for a recipe's look. Averaged pictures have such lines, too: they are drawn once, over the average.
Result<ParameterBytes> line_parameters(const Recipe& recipe);

/// Returns the planes from which lines are traced.
std::span<const std::string_view> edge_planes();

/// Traces the lines of a picture from its edge_planes, which include the guard band. Points are in pixels of the
/// picture without the guard band; lines entirely outside of the picture are left out. Uses `threads` threads; the
/// result does not depend on their number.
Lines traced_lines(const PictureInfo& info, const Image& planes, const ParameterBytes& outline_params, int threads);

/// Traces the lines of a frame on which `outline` has run. Errors: those of Device::download.
Result<Lines> traced_lines(Device& device, const Frame& frame, const ParameterBytes& outline_params);

/// Returns the sRGB-encoded colour of the lines.
std::array<float, 3> line_color(const ParameterBytes& outline_params);
float line_opacity(const ParameterBytes& outline_params);

}  // namespace umbrage
