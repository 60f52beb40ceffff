// The makers of the built-in scenes, one file each: <name>.cpp. Each returns a scene that is not finished yet
// (make_builtin_scene does that), with about the wanted number of triangles.
#pragma once
#include "scene/scene.h"

namespace umbrage {

/// What the sun spans in the sky, seen from the earth.
inline constexpr float kSunAngleDeg = 0.53f;
/// What a light spans that stands for a bright part of the sky or a lit wall: wide enough to have no edge of shadow.
inline constexpr float kFillAngleDeg = 40.0f;

Scene make_atrium(int triangles);
Scene make_room(int triangles);
Scene make_terrain(int triangles);
Scene make_solids(int triangles);
Scene make_pink(int triangles);
Scene make_tank(int triangles);
Scene make_claw(int triangles);

}  // namespace umbrage
