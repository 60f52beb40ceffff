// Readers of this folder, by format of the model.
#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "core/result.h"
#include "scene/readers/import.h"
#include "scene/readers/obj.h"
#include "scene/scene.h"

namespace umbrage {

/// Reads a glTF file: the scene, pose and cameras that `settings` choose. Everything that may change the picture and is
/// not read adds a sentence to Scene::warnings. Returns nothing for a file of glTF 1.0. Errors: kFile; kUsage for a
/// scene or an animation that the file does not have.
std::optional<Result<Scene>> read_gltf(const std::filesystem::path& file, const ImportSettings& settings);

/// Reads the atoms (ATOM and HETATM) of the first model of a PDB file as spheres, before finish_scene. Of alternate
/// locations of an atom the first is drawn. Its B-factor, occupancy, charge, chain, residue and element are fields, of
/// which `field` chooses as in ImportSettings. Errors: kFile. Throws the exceptions of Gemmi.
Result<Scene> read_pdb(const std::filesystem::path& file, const std::optional<std::string>& field);

/// Reads the visible meshes of an FBX file of version 7, in its pose, with their materials. Errors: kFile.
Result<Scene> read_fbx(const std::filesystem::path& file);

/// Returns the text of a DAE file with its morphs applied, and geometries in their place, for Assimp, which reads no
/// morphs. Of several morphs of one geometry the first is applied. Empty if the file has none, or is invalid XML.
std::string with_dae_morphs(const std::string& text);

/// Reads the objects that the build of a .3mf file names, with their transforms, base materials, colours and textures.
/// Lengths are converted to millimetres. Errors: kFile.
Result<Scene> read_3mf(const std::filesystem::path& file);

/// Reads a VTK file, in its text format (.vtk) or in XML (.vtp, .vtu), of polygons or of an unstructured grid, of which
/// the surface is drawn, before finish_scene. Values of points and cells are fields, of which `field` chooses as in
/// ImportSettings. Errors: kFile.
Result<Scene> read_vtk(const std::filesystem::path& file, const std::optional<std::string>& field);

/// Reads the textures of the materials and places texture coordinates by their options -s and -o. Adds one warning per
/// missing or unreadable file, and one for maps that are placed otherwise than the first map of their material, which
/// are left out, since a mesh has one set of texture coordinates.
void import_obj_maps(const ObjFile& file, ObjScene& obj);

}  // namespace umbrage
