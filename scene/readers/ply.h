// Reader for PLY files: text and binary, faces, triangle strips, points and Gaussian splats.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/progress.h"
#include "core/result.h"
#include "scene/scene.h"

namespace umbrage {

/// Reads a PLY file into a scene, before finish_scene. Without faces, the vertices become points. Positions are read in
/// double precision. Normals, texture coordinates and colours are kept if every vertex has them; texture coordinates at
/// the corners of faces and colours of faces take their place. Vertices with the properties of a Gaussian become splats
/// (draw_splats); points without colours are coloured by an intensity or quality. Rows of a text file that lack a
/// number are left out, if they are few. The names in comments "TextureFile NAME" are returned in `textures`; the
/// textures themselves are not read: the material with the index of a name is to have it. Errors: kFile, naming the
/// wrong field; kInterrupted.
Result<Scene> read_ply(const std::filesystem::path& file, std::vector<std::string>& textures, Poll* poll = nullptr);

/// Returns whether a PLY file's header names a texture, or may do so: it is too long to find out.
bool ply_has_texture(const std::filesystem::path& file);

}  // namespace umbrage
