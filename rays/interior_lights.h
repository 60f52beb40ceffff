// Interior lights: lights for a scene without lights of its own when the camera is inside it.
#pragma once
#include <vector>

#include "core/gbuffer.h"
#include "rays/traced_scene.h"

namespace umbrage {

/// Returns lights, in world space, for a picture that the default lights hardly reach, such as a court or a hall: a sun
/// in the direction from which most of its light reaches visible surfaces, or, if sunlight cannot enter, a lamp below
/// the ceiling. Empty if the first of `defaults` (world space, directional) lights the visible surfaces enough, or if
/// nothing is visible.
std::vector<Light> interior_lights(const TracedScene& traced, const PictureInfo& info,
                                   const std::vector<Light>& defaults);

}  // namespace umbrage
