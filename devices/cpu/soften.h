// Soft shadows without their grain: a filter along surfaces for shadows whose rays differ from pixel to pixel in blocks
// of 4 x 4.
#pragma once
#include <span>
#include <string>

#include "core/gbuffer.h"
#include "core/image.h"

namespace umbrage {

/// Averages each named plane of the first layer over the 4 x 4 pixels around, of those that lie on the same plane as
/// the pixel, within a pixel's size, and face alike: what repeats every 4 pixels is gone. Where all around is alike
/// nothing changes. Uses all threads of the calling task arena; the result does not depend on their number.
void soften_shadows(const PictureInfo& info, std::span<const std::string> names, Image& image);

}  // namespace umbrage
