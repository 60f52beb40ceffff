// The strokes of a drawn picture: its lines as curves. The effects `outline`, `hidden` and `hatching` trace them from
// planes that remain in the frame. Therefore they can be traced again after drawing.
#pragma once
#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "core/strokes.h"
#include "renderer/recipe.h"

namespace umbrage {

/// Parameters of the effects whose lines a picture has; empty for an effect whose lines it does not have.
struct StrokeParameters {
  ParameterBytes outline, hidden, hatching;

  bool empty() const { return outline.empty() && hidden.empty() && hatching.empty(); }
};

/// Returns the parameters of those of these effects that draw lines that are curves. `subject` is the start of the
/// error message, such as "the look 'ao' draws". Errors: kUsage if there are no such lines.
Result<StrokeParameters> stroke_parameters(std::string_view subject, std::span<const std::string_view> effects,
                                           const EffectSettings& settings);
/// Does the same for a recipe's look. Averaged pictures have such lines, too: they are drawn once, over the average.
Result<StrokeParameters> stroke_parameters(const Recipe& recipe);
/// Returns the same, or empty parameters if there are no such lines.
StrokeParameters stroke_parameters_or_none(const Recipe& recipe);

/// Returns the steps that draw these lines.
std::vector<EffectStep> line_steps(const StrokeParameters& params);

/// Returns the planes from which these lines of a picture with this number of layers are traced.
std::vector<std::string_view> edge_planes(const StrokeParameters& params, int layers);

/// Traces the lines of a picture from its edge_planes, which include the guard band. Points are in pixels of the
/// picture without the guard band; lines entirely outside of the picture are left out. Uses `threads` threads; the
/// result does not depend on their number.
Strokes traced_strokes(const PictureInfo& info, const Image& planes, const StrokeParameters& params, int threads);

/// Traces the lines of a frame on which the effects have run. Errors: those of Device::download.
Result<Strokes> traced_strokes(Device& device, const Frame& frame, const StrokeParameters& params);

/// Return the sRGB-encoded colour of the lines, and their opacity: those of `outline`, which hatching has too.
std::array<float, 3> stroke_color(const StrokeParameters& params);
float stroke_opacity(const StrokeParameters& params);

}  // namespace umbrage
