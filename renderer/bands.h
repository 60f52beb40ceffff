// Pictures too large to be held at once, drawn in bands: see core/band.h.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "core/lines.h"
#include "renderer/job.h"

namespace umbrage {

/// How a picture is drawn in bands.
struct BandPlan {
  int rows = 0;                     ///< of a band, a multiple of 4 (of 64, as planned); 0: the picture is drawn whole
  std::vector<std::string> planes;  ///< that are wanted of it
  double bytes = 0.0;               ///< that drawing takes, about
  Lines* lines = nullptr;           ///< gets the lines of a look that line_parameters takes, if there is one
};

/// How to draw such a picture with about so many bytes: whole where they suffice and it has no more than kMostPixels,
/// else in bands, of the fewest rows if not even these do. Devices that draw no bands, and techniques that trace the
/// scene, draw it whole. Errors: kUsage where it is too large for that.
Result<BandPlan> plan_bands(const Device& device, const DrawSettings& settings, double memory);

/// Takes rows of a finished picture with the plan's planes, from its top down; `first` is the first of them.
using TakeRows = std::function<Result<void>(const PictureInfo& info, const Image& rows, int first)>;

/// Draws a prepared scene as draw does, to the bit the same, in bands. Errors: as of draw.
Result<void> draw_bands(Device& device, Scene& scene, const DrawSettings& settings, const BandPlan& plan,
                        const TakeRows& take, StageTimes& times);

}  // namespace umbrage
