// Readers of model formats that need no library. Each returns a scene before finish_scene.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "core/result.h"
#include "scene/scene.h"

namespace umbrage {

/// Reads an OFF file (also COFF, NOFF, STOFF and their combinations) into a scene of one mesh, before finish_scene.
/// Positions are read in double precision. Without polygons, the vertices become points. Colours of faces are kept if
/// vertices have none. Errors: kFile, naming the wrong field; kInterrupted.
Result<Scene> read_off(const std::filesystem::path& file, Poll* poll = nullptr);

/// Reads a PLY file into a scene, before finish_scene. Without faces, the vertices become points. Positions are read in
/// double precision. Normals, texture coordinates and colours are kept if every vertex has them; texture coordinates at
/// the corners of faces and colours of faces take their place. Vertices with the properties of a Gaussian become splats
/// (draw_splats); points without colours are coloured by an intensity or quality. Rows of a text file that lack a
/// number are left out, if they are few. `field`: see ImportSettings; properties of vertices and faces that are
/// no lists are fields. The names in comments "TextureFile NAME" are returned in `textures`; the
/// textures themselves are not read: the material with the index of a name is to have it. Errors: kFile, naming the
/// wrong field; kInterrupted.
Result<Scene> read_ply(const std::filesystem::path& file, const std::optional<std::string>& field,
                       std::vector<std::string>& textures, Poll* poll = nullptr);

/// Returns whether a PLY file's header names a texture, or may do so: it is too long to find out.
bool ply_has_texture(const std::filesystem::path& file);

/// Reads a file of one point per line, x y z, separated by blanks, commas or semicolons. Among the columns that follow,
/// three numbers from 0 to 1, or integers from 0 to 255 or to 65535, are a colour, and three numbers that are a unit
/// vector in every line are a normal; other columns, such as an intensity, are ignored. Ignores lines that begin with #
/// or //, and lines with the number of points. A line of column names before the first point gives position, colour and
/// normal their places. Leaves out lines with fewer than
/// three numbers, with a warning, if they are few. A file of atoms is a molecule: see read_molecule. The scene has one
/// mesh, before finish_scene. `field`: see ImportSettings; columns after the position are fields, by their names in
/// lower case, or "column 4". Errors: kFile, naming the wrong line; kInterrupted.
Result<Scene> read_xyz(const std::filesystem::path& file, const std::optional<std::string>& field,
                       Poll* poll = nullptr);

/// Reads an STL file into a scene, before finish_scene: one mesh for a binary file, one for each solid of a text file,
/// with +z up. Vertices are not joined. Normals are not kept, since they are those of the faces. Colours of facets in
/// binary files are read after VisCAM and SolidView (bit 15 of the attribute: the facet has a colour) and, if the
/// header contains "COLOR=", after Magics (bit 15: the facet has the colour of the header). In text files, a facet that
/// lacks a number is left out, if these are few. Errors: kFile, naming counts or the line; kInterrupted.
Result<Scene> read_stl(const std::filesystem::path& file, Poll* poll = nullptr);

}  // namespace umbrage
