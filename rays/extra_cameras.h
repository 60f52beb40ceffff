// Extra cameras: where further cameras stand that see what a picture's own cannot, such as the back of a drape.
#pragma once
#include <vector>

#include "core/gbuffer.h"
#include "rays/traced_scene.h"

namespace umbrage {

/// Cameras that look at one point c on the axis of the picture's camera: a little before the median depth of what that
/// one sees, or where there is clearly more room around it, such as behind a drape that hangs in the middle. They look
/// from behind c, from both sides, from above, in this order; `count` of them, at most 4. Each stands as far from c as
/// the picture's eye, or nearer, so that nothing stands between it and c, and sees as much as that one around c, within
/// 110 degrees. Their projection and the picture's size, guard band included, are the picture's. They do not depend on
/// `count`.
std::vector<Camera> extra_cameras(const TracedScene& traced, const PictureInfo& info, int count);

}  // namespace umbrage
