// Fills of a drawing: the areas of a picture as closed paths.
#pragma once
#include <vector>

#include "core/drawing.h"
#include "core/image.h"

namespace umbrage {

enum class FillBy {
  kPart,  ///< an area per object, of its mean colour
  kTone,  ///< areas per object and tone: colours of the object that are near each other
};

/// Returns a layer `fill` per object, with a path for each of its areas of one colour, which may be in several places.
/// `picture`: planes color.r, .g, .b, sRGB, and object_id; pixels with object_id below 0 have no area. Neighbouring
/// areas share their border, fitted to the pixels' within about half a pixel. A tone is at least three pixels wide.
/// Source: ours.
std::vector<DrawnLayer> filled_regions(const Image& picture, FillBy by);

}  // namespace umbrage
