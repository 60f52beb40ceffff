// Reader for PLY files: text and binary, faces and triangle strips.
#pragma once
#include <filesystem>

#include "core/progress.h"
#include "core/result.h"
#include "scene/scene.h"

namespace umbrage {

/// Reads a PLY file into a scene of one mesh, before finish_scene. Polygons are split into triangle fans. Without
/// polygons, the vertices become points. Normals, texture coordinates and colours are kept if every vertex has them.
/// The name in `comment TextureFile NAME` is returned in `texture_name`; the texture itself is not read. Errors: kFile,
/// naming the wrong field; kInterrupted.
Result<Scene> read_ply(const std::filesystem::path& file, std::string& texture_name, Poll* poll = nullptr);

/// Returns the texture that a PLY file's header names; empty if there is none.
std::string ply_texture(const std::filesystem::path& file);

}  // namespace umbrage
