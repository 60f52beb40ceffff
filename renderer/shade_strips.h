// G-buffer files too large for memory, shaded in strips: see core/strip.h. Internal to renderer/ but for
// plan_file_strips.
#pragma once
#include "renderer/shade_file.h"

namespace umbrage {

/// Plans the shading of a file as plan_strips does, for the memory with which the file was opened. `recipe`: from
/// make_file_recipe. Errors: kUsage if the picture is too large for the device.
Result<StripSizes> plan_file_strips(const Device& device, const GBufferFile& file, const Recipe& recipe);

/// Shades a file in strips of `rows` rows, a multiple of 4. The result is bitwise identical to that of shade_planes.
/// Errors: as shade_file.
Result<SequenceStart> shade_strips(Device& device, const GBufferFile& file, const Recipe& recipe, int rows,
                                   const std::vector<std::string>& planes, const TakeRows& take,
                                   const std::optional<SequenceStart>& start, StageTimes& times,
                                   const ProgressMonitor& monitor = {});

}  // namespace umbrage
