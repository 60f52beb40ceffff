// Reader for points in text form: XYZ files, and OBJ files without faces.
#pragma once
#include <filesystem>

#include "core/progress.h"
#include "core/result.h"
#include "scene/scene.h"

namespace umbrage {

/// Reads a file of one point per line, x y z, separated by blanks, commas or semicolons. Among the columns that follow,
/// three integers from 0 to 255 are a colour, and three numbers that are a unit vector in every line are a normal;
/// other columns, such as an intensity, are ignored. Ignores lines that begin with # or //, lines with the number of
/// points, and a first line of column names, which may give x, y and z another place. Leaves out lines with fewer than
/// three numbers, with a warning, if they are few. A file of atoms is a molecule: see read_molecule. The scene has one
/// mesh, before finish_scene. Errors: kFile, naming the wrong line; kInterrupted.
Result<Scene> read_xyz(const std::filesystem::path& file, Poll* poll = nullptr);

/// Returns whether the text of an OBJ file has vertices but neither faces nor lines.
bool is_obj_of_points(std::string_view text);

/// Reads the text of an OBJ file without faces: vertices, colours if every vertex has one, and normals if there are as
/// many normals as vertices. Errors: kFile, naming the wrong line.
Result<Scene> read_obj_points(const std::filesystem::path& file, std::string_view text);

}  // namespace umbrage
