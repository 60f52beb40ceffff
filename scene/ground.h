// Ground: a disc below a model that has no ground of its own.
#pragma once
#include <optional>

#include "scene/scene.h"

namespace umbrage {

/// Returns whether a scene has no ground of its own. Seen from straight above, along Scene::up, a scene with ground is
/// flat and wide like a landscape, or has a level slab near its bottom that is visible in a large part of its plan. The
/// floor of a house is below its roof and does not count.
bool lacks_ground(const Scene& scene);

/// Adds a white diffuse disc under the scene, several times wider than it, as an object of its own
/// (Scene::ground_object). The bounds stay those of the model. `lowest_light_deg` is the height of the lowest light
/// above the horizon: the disc then extends as far as its shadows do, up to a limit, and shadows fade over its outer
/// half (Scene::ground_fade_distance).
void add_ground(Scene& scene, std::optional<float> lowest_light_deg = {});

}  // namespace umbrage
