// Contact sheet: a small picture of each layer of image files, in a grid.
#pragma once
#include <string>
#include <vector>

#include "core/image.h"
#include "core/result.h"
#include "gbuffers/settings.h"

namespace umbrage {

struct ContactSheet {
  Image picture;  ///< color.r .g .b, display values 0 to 1
  int columns = 1;
  std::vector<std::string> layers;  ///< of each cell, row by row
};

/// Draws all layers of the settings' files: colours as sRGB, vectors with -1..1 as 0..1, single channels from their max
/// (black) to their min (white), without the outermost values; pixels without a number are dark blue. Errors: kFile.
Result<ContactSheet> draw_contact_sheet(const GBufferSettings& settings);

}  // namespace umbrage
