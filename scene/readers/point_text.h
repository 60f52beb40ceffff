// Points as text: XYZ files, and OBJ files without faces.
#pragma once
#include <filesystem>

#include "core/progress.h"
#include "core/result.h"
#include "scene/scene.h"

namespace umbrage {

/// Reads a file of one point per line, x y z, parted by blanks, commas or semicolons. Of what may follow, three whole
/// numbers from 0 to 255 are a colour, three numbers that are a unit vector in every line are a normal; others, such as
/// an intensity, are passed over. Lines that begin with # or //, and a first line that counts the points, are passed
/// over too. The scene has one mesh and is not finished yet. Errors: kFile, with the line that is wrong;
/// kInterrupted.
Result<Scene> read_xyz(const std::filesystem::path& file, Poll* poll = nullptr);

/// Whether the text of an OBJ file has vertices but neither faces nor lines.
bool is_obj_of_points(std::string_view text);

/// Reads such a text: its vertices, with colours where all have them, and normals where there are as many.
Result<Scene> read_obj_points(const std::filesystem::path& file, std::string_view text);

}  // namespace umbrage
