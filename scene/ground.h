// Ground: what a model in the open is put on, so that it stands and does not float.
#pragma once
#include <optional>

#include "scene/scene.h"

namespace umbrage {

/// Whether a scene has no ground of its own: seen from straight above, along Scene::up, it is neither flat and wide as
/// a landscape, nor stands on a slab that fills most of its plan. The floor of a house lies under its roof and is none.
bool lacks_ground(const Scene& scene);

/// Adds a white matte disc under the scene, far wider than it, of an object of its own (Scene::ground_object). Bounds
/// stay those of the model. Where some light stands low, so many degrees above the horizon, the disc reaches as far as
/// its shadows do, up to a limit, and shade fades over its outer half (Scene::ground_fades).
void add_ground(Scene& scene, std::optional<float> lowest_light_deg = {});

}  // namespace umbrage
