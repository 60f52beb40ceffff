// PLY files: text and binary, faces and triangle strips.
#pragma once
#include <filesystem>

#include "core/progress.h"
#include "core/result.h"
#include "scene/scene.h"

namespace umbrage {

/// Reads a PLY file into a scene of one mesh, which is not finished yet. Polygons are cut into fans; without any, the
/// vertices are points. Normals, texture coordinates and colours are kept where every vertex has them; `comment
/// TextureFile NAME` gives its one material no texture but is returned in `texture_name`. Errors: kFile, with the
/// field that is wrong; kInterrupted.
Result<Scene> read_ply(const std::filesystem::path& file, std::string& texture_name, Poll* poll = nullptr);

/// The texture that a PLY file's header names; empty where there is none.
std::string ply_texture(const std::filesystem::path& file);

}  // namespace umbrage
