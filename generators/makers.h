// Functions that make the built-in scenes, each in its own file <name>.cpp. They return an unfinished scene, which
// make_builtin_scene finishes, with about the requested number of triangles.
#pragma once
#include "scene/scene.h"

namespace umbrage {

/// Angular diameter of the sun as seen from the earth.
inline constexpr float kSunAngleDeg = 0.53f;
/// Angular diameter of a light that represents a bright part of the sky or a lit wall: wide enough for shadows without
/// an edge.
inline constexpr float kFillAngleDeg = 40.0f;

Scene make_atrium(int triangles);
Scene make_room(int triangles);
Scene make_terrain(int triangles);
Scene make_solids(int triangles);
Scene make_pink(int triangles);
Scene make_tank(int triangles);
Scene make_claw(int triangles);

}  // namespace umbrage
