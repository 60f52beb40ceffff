// Extra cameras: further viewpoints for surfaces that the picture's camera does not see, such as the back of a drape.
#pragma once
#include <vector>

#include "core/gbuffer.h"
#include "rays/traced_scene.h"

namespace umbrage {

/// Returns `count` cameras, at most 4, that look at one point c on the axis of the picture's camera. c is slightly in
/// front of the median depth of the visible surfaces, or at a depth with clearly more free space around it, such as
/// behind a drape in the middle of the picture. The cameras look from behind c, from both sides, and from above, in
/// this order. Each is as far from c as the picture's camera, or nearer, so that nothing is between it and c, and shows
/// as much as that camera around c, with a view angle of at most 110 degrees. Projection and picture size, guard band
/// included, are those of the picture. The cameras do not depend on `count`.
std::vector<Camera> extra_cameras(const TracedScene& traced, const PictureInfo& info, int count);

}  // namespace umbrage
