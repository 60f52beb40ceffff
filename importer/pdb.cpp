// Reader for PDB files, through Gemmi.
#include "importer/readers.h"

#include <gemmi/pdb.hpp>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "scene/readers/molecule.h"
#include "scene/readers/read_number.h"
#include "scene/readers/whole_file.h"

namespace umbrage {
namespace {

/// Atoms whose position is not three numbers, which Gemmi reads as 0.
struct BadAtoms {
  std::size_t count = 0, all = 0, first_line = 0;
};

/// Removes the lines of such atoms.
BadAtoms remove_bad_atoms(std::string& text) {
  constexpr std::size_t kPosition = 30, kWidth = 8;  // columns of x; y and z follow
  BadAtoms bad;
  std::string kept;
  kept.reserve(text.size());
  std::size_t number = 0;
  for (std::size_t at = 0, next = 0; at < text.size(); at = next) {
    next = std::min(text.find('\n', at), text.size() - 1) + 1;
    const std::string_view line = std::string_view(text).substr(at, next - at);
    ++number;
    bool is_good = true;
    if (line.starts_with("ATOM  ") || line.starts_with("HETATM")) {
      ++bad.all;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        std::string_view field = line.substr(std::min(kPosition + axis * kWidth, line.size()), kWidth);
        field.remove_prefix(std::min(field.find_first_not_of(' '), field.size()));
        const char* stop = field.data();
        double value = 0.0;
        is_good = is_good && read_number(stop, field.data() + field.size(), value) &&
                  std::string_view(stop, std::size_t(field.data() + field.size() - stop)).find_first_not_of(" \r\n") ==
                      std::string_view::npos;
      }
      if (!is_good && bad.count++ == 0) bad.first_line = number;
    }
    if (is_good) kept.append(line);
  }
  if (bad.count > 0) text = std::move(kept);
  return bad;
}

}  // namespace

Result<Scene> read_pdb(const std::filesystem::path& file) {
  auto text = read_whole_file(file);
  if (!text) return text.error();
  text->erase(0, text->size() - without_mark(*text).size());  // columns count
  if (text->find('\n') == std::string::npos) std::replace(text->begin(), text->end(), '\r', '\n');
  const BadAtoms bad = remove_bad_atoms(*text);
  const gemmi::Structure structure = gemmi::read_pdb_from_memory(text->data(), text->size(), file.string());
  std::vector<Atom> atoms;
  if (!structure.models.empty())
    for (const gemmi::Chain& chain : structure.models[0].chains)
      for (const gemmi::Residue& residue : chain.first_conformer())
        for (const gemmi::Atom& atom : residue.first_conformer())
          atoms.push_back({{atom.pos.x, atom.pos.y, atom.pos.z}, atom.element.name()});
  if (atoms.empty()) return file_error("'{}' has no atoms", file.string());
  Scene scene = scene_of_atoms(atoms, file);
  if (bad.count > 0)
    scene.warnings.push_back(
        fmt::format("{} of {} atoms have no position of three numbers and are left out, first in line {}", bad.count,
                    bad.all, bad.first_line));
  if (structure.models.size() > 1)
    scene.warnings.push_back(fmt::format("the file has {} models; the first is drawn", structure.models.size()));
  return scene;
}

}  // namespace umbrage
