// Reader for PDB files, through Gemmi.
#pragma once
#include <filesystem>

#include "core/result.h"
#include "scene/scene.h"

namespace umbrage {

/// Reads the atoms (ATOM and HETATM) of the first model of a PDB file as spheres, before finish_scene. Of alternate
/// locations of an atom the first is drawn. Errors: kFile. Throws the exceptions of Gemmi.
Result<Scene> read_pdb(const std::filesystem::path& file);

}  // namespace umbrage
