// Import of materials: what Assimp says of a surface becomes a Material, and its textures are found and read.
#pragma once
#include <filesystem>
#include <string>

#include "importer/gltf_facts.h"
#include "scene/scene.h"

struct aiScene;

namespace umbrage {

/// Appends one Material per material of `source`, in order, with the textures they need; textures used twice are read
/// once. What is missing becomes a sentence in scene.warnings. `format` is the file's ending in lower case.
///
/// Colours: 3DS keeps what was picked on a screen and is taken as sRGB; the factors of all other formats are linear.
///
/// Nothing is blended here: `left_out` gets, of each material, whether it is more clear than opaque everywhere.
void import_materials(const aiScene& source, const std::filesystem::path& file, const std::string& format,
                      const GltfFacts& gltf, Scene& scene, std::vector<bool>& left_out);

/// Appends the texture `name` that the model `file` refers to. Returns its index, or kNoTexture after a warning.
int import_texture(const std::filesystem::path& file, const std::string& name, Scene& scene);

}  // namespace umbrage
