// Interior lights: what shines on a scene without lights of its own whose camera stands inside it.
#pragma once
#include <vector>

#include "core/gbuffer.h"
#include "rays/traced_scene.h"

namespace umbrage {

/// Lights, in world space, for a picture that the usual lights hardly reach, such as a court or a hall: the sun from
/// where most of its light falls on what is seen; or, where it finds no way in, a lamp below the ceiling. Empty where
/// the first of `usual` (in world space, parallel) reaches enough, or nothing is seen.
std::vector<Light> interior_lights(const TracedScene& traced, const PictureInfo& info, const std::vector<Light>& usual);

}  // namespace umbrage
