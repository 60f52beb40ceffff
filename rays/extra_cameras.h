// Extra cameras: further viewpoints for surfaces that the picture's camera does not see, such as the back of a drape.
#pragma once
#include <vector>

#include "core/gbuffer.h"
#include "rays/traced_scene.h"

namespace umbrage {

/// Returns `count` cameras, at most 4, that look at one point c on the axis of the picture's camera. c is slightly in
/// front of the median depth of the visible surfaces, unless another depth has clearly more free space around it, such
/// as behind a drape in the middle of the picture. The cameras look from behind c, from both sides, and from above, in
/// this order. Each is as far from c as the picture's camera, or closer if something would be between it and c. Each
/// shows as large an area around c as the picture's camera does, but its view angle is at most 110 degrees. Projection
/// and picture size, guard band included, are the same as in the picture. A smaller `count` gives the first of the same
/// cameras.
std::vector<Camera> extra_cameras(const TracedScene& traced, const PictureInfo& info, int count);

}  // namespace umbrage
