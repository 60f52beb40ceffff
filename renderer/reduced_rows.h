// Reduces a finished picture by an integer factor while its rows arrive, from top to bottom.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "effects/output/output.h"
#include "renderer/recipe.h"
#include "renderer/strips.h"

namespace umbrage {

/// Returns a function that reduces the rows that it receives and passes them to `take`, with the information of the
/// reduced picture. A pixel of that is a block of factor x factor pixels; pixels beyond the last whole block are left
/// out. Light is averaged: `color` as linear light with the weight of alpha (display values of a look without a
/// transfer function as they are), other planes as they are. Geometry and ids are those of the middle of the block,
/// since an average belongs to no surface. Factor 1 returns `take`.
TakeRows reduced_rows(int factor, const Recipe& recipe, const TakeRows& take);

/// Returns the information of the reduced picture.
PictureInfo reduced_picture_info(PictureInfo info, int factor);

}  // namespace umbrage
