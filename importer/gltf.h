// Reader for glTF 2.0 files, .gltf and .glb.
#pragma once
#include <optional>

#include "scene/readers/import.h"

namespace umbrage {

/// Reads a glTF file: the scene, pose and cameras that `settings` choose. Everything that may change the picture and is
/// not read adds a sentence to Scene::warnings. Returns nothing for a file of glTF 1.0. Errors: kFile; kUsage for a
/// scene or an animation that the file does not have.
std::optional<Result<Scene>> read_gltf(const std::filesystem::path& file, const ImportSettings& settings);

}  // namespace umbrage
