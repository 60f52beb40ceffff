// Import of materials: converts Assimp's materials to Material, and finds and reads their textures.
#pragma once
#include <filesystem>
#include <string>

#include "scene/scene.h"

struct aiScene;

namespace umbrage {

/// Appends one Material per material of `source`, in order, and the textures that they need; each texture is read once.
/// Each missing file adds a sentence to scene.warnings. `format` is the file's extension in lower case.
///
/// Colours: 3DS stores colours as picked on a screen, so they are read as sRGB; those of all other formats are linear.
void import_materials(const aiScene& source, const std::filesystem::path& file, const std::string& format,
                      Scene& scene);

/// Appends the texture `name` that the model `file` refers to. Returns its index, or kNoTexture after adding a warning.
int import_texture(const std::filesystem::path& file, const std::string& name, Scene& scene);

}  // namespace umbrage
