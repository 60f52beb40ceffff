// Pictures too large to be held at once, drawn in bands: see core/band.h.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "core/lines.h"
#include "renderer/plan.h"
#include "renderer/times.h"

namespace umbrage {

/// How a picture is drawn in bands.
struct BandSizes {
  int rows = 0;        ///< of a band, a multiple of 4 (of 64, as planned); 0: the picture is drawn whole
  double bytes = 0.0;  ///< that drawing takes, about
};

/// How to draw such a picture with about so many bytes: whole where they suffice and it has no more than kMaxPixels,
/// else in bands, of the fewest rows if not even these do. Devices that draw no bands, and techniques that trace the
/// scene, draw it whole. Errors: kUsage where it is too large for that.
Result<BandSizes> plan_bands(const Device& device, const Recipe& recipe, double memory);

/// Takes rows of a finished picture with the planes that are wanted, from its top down; `first` is the first of them.
using TakeRows = std::function<Result<void>(const PictureInfo& info, const Image& rows, int first)>;

/// Draws a prepared scene as draw does, to the bit the same, in bands of so many rows, and hands out these planes.
/// Returns the lines of a look that line_parameters takes, where `lines` asks for them. Errors: as of draw.
Result<Lines> draw_bands(Device& device, const Plan& plan, int rows, const std::vector<std::string>& planes, bool lines,
                         const TakeRows& take, StageTimes& times, const ProgressMonitor& monitor = {});

}  // namespace umbrage
