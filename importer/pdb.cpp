#include "importer/pdb.h"

#include <gemmi/pdb.hpp>

#include <string>
#include <vector>

#include "scene/readers/molecule.h"
#include "scene/readers/obj_text.h"
#include "scene/readers/whole_file.h"

namespace umbrage {

Result<Scene> read_pdb(const std::filesystem::path& file) {
  auto text = read_whole_file(file);
  if (!text) return text.error();
  if (text->starts_with("\xef\xbb\xbf")) text->erase(0, 3);  // columns count
  normalize_lines(*text);
  const gemmi::Structure structure = gemmi::read_pdb_from_memory(text->data(), text->size(), file.string());
  std::vector<Atom> atoms;
  if (!structure.models.empty())
    for (const gemmi::Chain& chain : structure.models[0].chains)
      for (const gemmi::Residue& residue : chain.first_conformer())
        for (const gemmi::Atom& atom : residue.first_conformer())
          atoms.push_back({{atom.pos.x, atom.pos.y, atom.pos.z}, atom.element.name()});
  if (atoms.empty()) return file_error("'{}' has no atoms", file.string());
  Scene scene = scene_of_atoms(atoms, file);
  if (structure.models.size() > 1)
    scene.warnings.push_back(fmt::format("the file has {} models; the first is drawn", structure.models.size()));
  return scene;
}

}  // namespace umbrage
