// The lines of a drawn picture as curves. `outline` traces them as a function of planes that a frame keeps, which are
// the same on every device: whoever wants the lines traces them again.
#pragma once
#include <array>
#include <span>
#include <string_view>

#include "core/lines.h"
#include "renderer/recipe.h"

namespace umbrage {

/// The parameters of `outline` where these effects draw lines that are curves; `who` begins a sentence, such as "the
/// look 'ao' draws". Errors: kUsage where there are no such lines.
Result<ParameterBytes> line_parameters(std::string_view who, std::span<const std::string_view> effects,
                                       const EffectSettings& settings);
/// Those of a look: of averaged frames, too, whose lines are drawn once.
Result<ParameterBytes> line_parameters(const Recipe& recipe);

/// The planes that lines are traced from.
std::span<const std::string_view> edge_planes();

/// The lines of a picture from its edge_planes, which have the picture's whole size, guard band included. Points are in
/// pixels of the picture without that; lines wholly outside it are left out. Uses so many threads; the lines do not
/// depend on it.
Lines traced_lines(const PictureInfo& info, const Image& planes, const ParameterBytes& outline_params, int threads);

/// The same, of a frame on which `outline` has run. Errors: those of Device::download.
Result<Lines> traced_lines(Device& device, const Frame& frame, const ParameterBytes& outline_params);

/// Red, green and blue of lines as sRGB.
std::array<float, 3> line_color(const ParameterBytes& outline_params);
float line_opacity(const ParameterBytes& outline_params);

}  // namespace umbrage
