// Reader for points in text form: XYZ files.
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

}  // namespace umbrage
