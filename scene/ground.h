// Ground: a disc below a model that has no ground of its own.
#pragma once
#include <optional>

#include "scene/scene.h"

namespace umbrage {

/// Returns whether a scene has no ground of its own. Seen from straight above, along Scene::up, a scene with ground is
/// flat and wide like a landscape, or has a level slab near its bottom that is visible in a large part of its plan. The
/// floor of a house is below its roof and does not count.
bool lacks_own_ground(const Scene& scene);

/// Adds a white diffuse disc under the scene, several times wider than the scene, as a separate object
/// (Scene::ground_object). The bounds of the scene do not change. Shadows fade out from half of
/// Scene::ground_fade_distance on, which is 1.4 radii of the scene. `lowest_light_deg`: height of the lowest light
/// above the horizon, degrees; if set, the disc extends as far as the shadows of this light do, up to a limit, and
/// shadows fade out over the outer half of the disc.
void add_ground(Scene& scene, std::optional<float> lowest_light_deg = {});

}  // namespace umbrage
