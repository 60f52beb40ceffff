// The textures of an OBJ file's materials.
#pragma once
#include "scene/readers/obj.h"

namespace umbrage {

/// Reads the textures of the materials and places texture coordinates by their options -s and -o. Adds one warning per
/// missing or unreadable file, and one for maps that are placed otherwise than the first map of their material, which
/// are left out, since a mesh has one set of texture coordinates.
void import_obj_maps(const ObjFile& file, ObjScene& obj);

}  // namespace umbrage
