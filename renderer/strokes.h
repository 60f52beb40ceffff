// The strokes of a drawn picture: its lines as curves. Effects with Effect::without_lines trace them from planes that
// remain in the frame. Therefore they can be traced again after drawing.
#pragma once
#include <array>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "core/strokes.h"
#include "renderer/recipe.h"

namespace umbrage {

/// The effects whose lines a picture has, in the order of the look, with parameters that draw them alone.
using StrokeParameters = std::vector<EffectStep>;

/// Returns the parameters of the effect with this params struct, or null if the list does not have it.
template <class Params>
const Params* find_params(const StrokeParameters& lines) {
  for (const EffectStep& each : lines)
    if (each.effect == &effect_with<Params>()) return &as<Params>(each.params);
  return nullptr;
}

/// Removes the lines of these effects that are curves from what they draw with `settings`, and returns these lines.
StrokeParameters take_lines(std::span<const Effect* const> effects, EffectSettings& settings);

/// Does the same with the lines that a recipe draws once, over an average. Those of outline.mode=paper are drawn in
/// each sample, and hidden lines with them.
StrokeParameters take_lines_over_average(const Recipe& recipe, EffectSettings& settings);

/// Returns the lines of a recipe's look, which are all curves. Averaged pictures have such lines, too: they are drawn
/// once, over the average. Errors: kUsage if there are no such lines.
Result<StrokeParameters> stroke_parameters(const Recipe& recipe);
/// Returns the same, or an empty list if there are no such lines.
StrokeParameters stroke_parameters_or_none(const Recipe& recipe);

/// Returns the planes from which these lines of a picture with this number of layers are traced.
std::vector<std::string_view> edge_planes(const StrokeParameters& params, int layers);

/// Returns the dispatch of an effect with lines that traces them.
const Dispatch& tracing_dispatch(const Effect& effect);
/// Calls `step` with that dispatch and its inputs, from a picture's planes with the guard band, in an arena of
/// `threads` threads.
void run_tracing(const EffectStep& lines, const PictureInfo& info, const Image& planes, int threads,
                 const std::function<void(const Dispatch&, const HostFrame&)>& step);

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
