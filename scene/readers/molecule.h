// Molecules: atoms as spheres, and the reader of the XYZ format of chemistry.
#pragma once
#include <filesystem>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/progress.h"
#include "core/result.h"
#include "scene/scene.h"

namespace umbrage {

inline constexpr std::string_view kColumnBlank = " \t\r,;";  ///< what separates the columns of a text

struct Atom {
  glm::dvec3 position;
  std::string symbol;  ///< begins with an element's symbol
};

/// Returns a scene, before finish_scene, with each atom as a sphere: of the colour and the van der Waals radius of its
/// element. Adds a warning that names symbols without an element.
Scene scene_of_atoms(const std::vector<Atom>& atoms, const std::filesystem::path& file);

/// Returns whether a text in XYZ form is a molecule: one of the first lines is an element and three numbers; atomic
/// numbers stand for elements if a count and a comment precede them; or the second line has "Properties=".
bool is_molecule(std::string_view text);

/// Reads the text of a molecule: the number of atoms, a comment, and a line for each atom, "C 0.0 0.0 0.0"; the first
/// two lines may be missing. "Properties=" in the comment gives the columns [extended XYZ]. Of several frames the first
/// is read, with a warning. A line without an element or three numbers is left out, with a warning, if these are few.
/// Errors: kFile, naming the line; kInterrupted.
Result<Scene> read_molecule(const std::filesystem::path& file, std::string_view text, Poll* poll = nullptr);

}  // namespace umbrage
