// 3MF, the format of 3D printing, by the 3MF core specification 1.3 and its materials and production extensions. Used
// instead of Assimp, since Assimp 5.2 drops the colours of triangles.
#pragma once
#include <filesystem>

#include "core/result.h"
#include "scene/scene.h"

namespace umbrage {

/// Reads the objects that the build of a .3mf file names, with their transforms, base materials, colours and textures.
/// Lengths are converted to millimetres. Errors: kFile.
Result<Scene> read_3mf(const std::filesystem::path& file);

}  // namespace umbrage
