// The makers of the built-in scenes, one file each: builtin_<name>.cpp. Each returns a scene that is not finished yet
// (make_builtin_scene does that), with about the wanted number of triangles.
#pragma once
#include "scene/scene.h"

namespace umbrage {

Scene make_atrium(int triangles);
Scene make_room(int triangles);
Scene make_terrain(int triangles);
Scene make_solids(int triangles);
Scene make_pink(int triangles);
Scene make_tank(int triangles);
Scene make_claw(int triangles);

}  // namespace umbrage
