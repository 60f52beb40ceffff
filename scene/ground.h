// Ground: a disc below a model of which the picture shows no ground of its own.
#pragma once
#include <optional>

#include "core/camera.h"
#include "scene/scene.h"

namespace umbrage {

/// Returns whether the foot of a picture, the middle of its lower border, shows ground of the scene's own: from most
/// azimuths around the vertical axis through the scene's centre, the first surface there is less steep than 45 degrees.
/// So the answer is the same all along an orbit. A model that ends above the border, such as a house on its slab, shows
/// none, and neither does one whose walls reach to it. Surfaces below others, and Scene::ground_object, do not count.
bool shows_own_ground(const Scene& scene, const Camera& camera);

/// Adds a white diffuse disc under the scene, several times wider than the scene, as a separate object
/// (Scene::ground_object). The bounds of the scene do not change. Shadows fade out from half of
/// Scene::ground_fade_distance on, which is 1.4 radii of the scene. `lowest_light_deg`: height of the lowest light
/// above the horizon, degrees; if set, the disc extends as far as the shadows of this light do, up to a limit, and
/// shadows fade out over the outer half of the disc.
void add_ground(Scene& scene, std::optional<float> lowest_light_deg = {});

}  // namespace umbrage
