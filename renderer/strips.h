// Pictures too large for memory, drawn in strips: see core/strip.h. Reduction of a finished picture by an integer
// factor while its rows arrive, from top to bottom.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "core/strokes.h"
#include "renderer/plan.h"
#include "renderer/strip_drawer.h"
#include "renderer/times.h"

namespace umbrage {

/// Plans the drawing of a plan for about `memory` bytes: see strip_drawer.h. Errors: kUsage.
Result<StripSizes> plan_strips(const Device& device, const Plan& plan, double memory);

/// Receives finished rows with the requested planes, from top to bottom; `first` is the index of the first row.
using TakeRows = std::function<Result<void>(const PictureInfo& info, const Image& rows, int first)>;

/// Draws a prepared scene in strips of `rows` rows and passes `planes` to `take`. The result is bitwise identical to
/// that of draw. Returns the lines that stroke_parameters selects if `lines` is set. Errors: as draw.
Result<Strokes> draw_strips(Device& device, const Plan& plan, int rows, const std::vector<std::string>& planes,
                            bool lines, const TakeRows& take, StageTimes& times, const ProgressMonitor& monitor = {});

/// Returns a function that reduces the rows that it receives and passes them to `take`, with the information of the
/// reduced picture. A pixel of that is a block of factor x factor pixels; pixels beyond the last whole block are left
/// out. Light is averaged: `color` as linear light with the weight of alpha (display values of a look without a
/// transfer function as they are), other planes as they are. Geometry and ids are those of the middle of the block,
/// since an average belongs to no surface. Factor 1 returns `take`.
TakeRows reduced_rows(int factor, const Recipe& recipe, const TakeRows& take);

/// Returns the information of the reduced picture.
PictureInfo reduced_picture_info(PictureInfo info, int factor);

}  // namespace umbrage
