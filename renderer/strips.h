// Pictures too large for memory, drawn in strips: see core/strip.h.
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

}  // namespace umbrage
