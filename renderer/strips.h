// Pictures too large for memory, drawn in strips: see core/strip.h.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "core/strokes.h"
#include "renderer/plan.h"
#include "renderer/times.h"

namespace umbrage {

/// How a picture is split into strips.
struct StripSizes {
  int rows = 0;        ///< rows of a strip, a multiple of 4 (of 64 as planned); 0: the picture is drawn whole
  double bytes = 0.0;  ///< estimated memory for drawing, bytes
  /// Whether that is more than the limit, on a device that holds pictures in the memory of the host.
  bool exceeds = false;
};

/// Max number of planes of a captured layer, with two further shadows, emission and those of materials.
inline constexpr int kMaxCaptured = 21;

/// Plans a picture for about `memory` bytes: whole if they suffice and it has at most kMaxPixels pixels, else in
/// strips, of the minimum height if even these need more, or whole if strips would not need less. Devices that cannot
/// draw strips and techniques that trace the scene draw the picture whole. Errors: kUsage if it is too large for that.
/// `captured`: number of planes of a layer before any effect runs.
Result<StripSizes> plan_strips(const Device& device, const Recipe& recipe, double memory, int captured = kMaxCaptured);

/// Receives finished rows with the requested planes, from top to bottom; `first` is the index of the first row.
using TakeRows = std::function<Result<void>(const PictureInfo& info, const Image& rows, int first)>;

/// Draws a prepared scene in strips of `rows` rows and passes `planes` to `take`. The result is bitwise identical to
/// that of draw. Returns the lines that stroke_parameters selects if `lines` is set. Errors: as draw.
Result<Strokes> draw_strips(Device& device, const Plan& plan, int rows, const std::vector<std::string>& planes,
                            bool lines, const TakeRows& take, StageTimes& times, const ProgressMonitor& monitor = {});

}  // namespace umbrage
