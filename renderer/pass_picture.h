// Pictures of passes, for files and displays that hold display values.
#pragma once
#include <string>
#include <vector>

#include "core/gbuffer.h"
#include "looks/settings.h"

namespace umbrage {

/// Converts the planes `names` of passes to display values: colours and light are encoded by sRGB, vectors map from
/// [-1, 1] to [0, 1], depth from white (near) to black (far). One plane keeps its name; several become color.r, .g, .b
/// and .a. `info`: for the range of depth.
Image picture_of_passes(const Image& frame, const std::vector<std::string>& names, const PictureInfo& info);

/// Returns lines alone, in their colour, with alpha. `cover`: the pass `outline`.
Image picture_of_lines(const Plane& cover, const EffectSettings& settings);

}  // namespace umbrage
