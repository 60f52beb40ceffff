// Depths that are stored in steps: of 8 bits, of half floats, or of a depth camera whose disparities are integers.
//
// Normals of a surface in steps are those of a staircase. A stored depth is therefore taken for an interval, from the
// step below it to the step above it, and smoothing finds a surface within these intervals that is as linear as
// possible: inverse depth, which is linear on planes, is averaged over pairs of opposite pixels, first far ones, then
// near ones. A pair that does not continue the surface of the pixel, by more than the steps explain, has no weight.
#pragma once
#include <span>
#include <vector>

#include "core/image.h"
#include "core/strip.h"

namespace umbrage {

/// Rows above and below a pixel that smoothed_steps reads.
inline constexpr int kStepsMargin = 96;

/// Returns the different depths of a picture, ascending, if they are steps that tilt surfaces visibly; else nothing.
/// `bands`: view depth of rows that are spread over the picture. `pixel_size`: width of a pixel at depth 1, or at any
/// depth if `orthographic`. `unit`: difference of depths by which all are stored, 0 if unknown; becomes 0 if the steps
/// are larger, as those of depth cameras.
std::vector<float> depth_steps(std::span<const Plane> bands, float pixel_size, bool orthographic, float& unit);

/// Adds the depths of rows that `levels`, ascending, lacks. smoothed_steps needs those of the whole picture.
void add_levels(const Plane& depth, std::vector<float>& levels);

/// Returns the rows [own.begin, own.end) of `depth`, counted from its first row, without steps. There must be
/// kStepsMargin further rows on either side, except at the border of the picture.
/// `unit` limits the change, if it is not 0.
Plane smoothed_steps(const Plane& depth, const Rows& own, const std::vector<float>& levels, bool orthographic,
                     float unit);

}  // namespace umbrage
