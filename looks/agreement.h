// What pictures of one scene, each sampled elsewhere within its pixels, agree on of the lines that they have.
//
// Whether a soft fold has a line, and where it ends, can hang on where within its pixels a picture has its samples. The
// mean of such pictures has grey threads and crumbs there, which no picture has. Where pictures disagree the line of
// one of them is taken whole instead.
#pragma once
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "core/image.h"

namespace umbrage {

inline constexpr int kFullCover = 255;

/// Two pictures have no majority.
inline constexpr int kLeastThatAgree = 3;

/// The lines of one picture.
struct LinePicture {
  /// Where it has its samples, in pixels to the right of their centres and below, within (-0.5, 0.5).
  glm::vec2 offset;
  std::vector<std::uint8_t> cover;  ///< the share of each pixel that lines hide, of their opacity, by rows
};

/// Of each pixel the share that lines hide, 0 to `opacity`. `mean`: that of all pictures, which is what is left where
/// they agree. `pictures`: three or more of them, of the mean's size. `width_px`: of a line. Throws InternalError where
/// sizes or counts are others.
///
/// Pictures disagree at a pixel where what one of them has there, in the mean over 3 x 3 pixels, no place up to a pixel
/// away has in another, by about a sixth (see kDisputed): more than moving them by fractions of a pixel does. Lines
/// that are fainter in that mean stay the mean of all: of lines a pixel wide those that are drawn less than half as
/// dark, where the width is one. Nothing is asked within two pixels of the picture's border. What joins such pixels,
/// with half a line's width around them, is a place in dispute. There one picture is taken, moved to the pixels'
/// centres: that of the least sum of what free ends, holes and differences from the others cost; of equals the last. Of
/// up to six pictures it may be two together, if that closes gaps.
Plane agreed_lines(std::span<const LinePicture> pictures, Plane mean, float opacity, float width_px);

}  // namespace umbrage
