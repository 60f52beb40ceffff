// Reader for PDB files, through Gemmi.
#include "importer/readers.h"

#include <gemmi/pdb.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/readers/field_columns.h"
#include "scene/readers/molecule.h"
#include "scene/readers/read_number.h"
#include "scene/readers/text_rules.h"
#include "scene/readers/whole_file.h"

namespace umbrage {
namespace {

// Columns of a line, from 0: x, y and z of 8 characters each; from kOld on, programs of before 1996 have an identifier
// and the number of the line, others segment, element and charge.
constexpr std::size_t kPosition = 30, kWidth = 8, kOld = 72, kElement = 76, kCharge = 78, kEnd = 80;

/// The values of atoms: chains are numbered in the order of the file, from 1.
const std::vector<FileColumn> kAtomColumns = {{"b_factor"}, {"occupancy"}, {"charge"},
                                              {"chain"},    {"residue"},   {"element"}};

/// Atoms whose position is not three numbers in their columns, which Gemmi reads as 0 or as another number.
struct BadAtoms {
  std::size_t count = 0, all = 0, first_line = 0;
  bool is_misplaced = false;                        ///< the first one has three numbers elsewhere
  std::size_t shifted = 0, first_shifted_line = 0;  ///< with three numbers that end before their columns do
  std::size_t comma_line = 0;                       ///< first line with decimal commas; 0: none
};

std::string_view columns_of(std::string_view line, std::size_t first, std::size_t end) {
  return line.substr(std::min(first, line.size()), end - first);
}

enum class Position { kGood, kShifted, kBad };

/// Looks at the three numbers of a position: each has a point and ends with its columns.
Position check_position(std::string_view line) {
  Position result = columns_of(line, kPosition - 1, kPosition) == " " ? Position::kGood : Position::kBad;
  for (std::size_t first = kPosition; first < kPosition + 3 * kWidth; first += kWidth) {
    std::string_view field = columns_of(line, first, first + kWidth);
    const bool ends_early = field.size() < kWidth || field.back() == ' ';
    field.remove_prefix(std::min(field.find_first_not_of(' '), field.size()));
    field = field.substr(0, field.find_last_not_of(" \r\n") + 1);
    if (!number_of(field) || field.find('.') == std::string_view::npos) return Position::kBad;
    if (ends_early && result == Position::kGood) result = Position::kShifted;
  }
  return result;
}

/// Returns whether the first three words with a point, from the residue's number on, are numbers.
bool has_numbers(std::string_view line) {
  constexpr std::size_t kFrom = kPosition - 8;
  int count = 0;
  for (std::string_view rest = columns_of(line, kFrom, line.size()); !rest.empty() && count < 3;) {
    rest.remove_prefix(std::min(rest.find_first_not_of(" \r\n"), rest.size()));
    const std::string_view word = rest.substr(0, rest.find_first_of(" \r\n"));
    rest.remove_prefix(word.size());
    if (word.find('.') == std::string_view::npos) continue;
    if (!number_of(word)) return false;
    ++count;
  }
  return count == 3;
}

/// Returns whether columns 73 to 80 are not a segment, an element of letters and a charge such as "2+".
bool is_old(std::string_view line) {
  const std::string_view element = columns_of(line, kElement, kCharge), charge = columns_of(line, kCharge, kEnd);
  const auto is_none_of = [](char c, std::string_view set) { return set.find(c) == std::string_view::npos; };
  return std::any_of(element.begin(), element.end(), [](char c) { return c >= '0' && c <= '9'; }) ||
         (charge.size() == 2 && charge != "  " && is_none_of(charge[0], "+-") && is_none_of(charge[1], "+-\r\n"));
}

/// Removes the lines of bad atoms, and columns 73 to 80 of old lines.
BadAtoms clean_atoms(std::string& text) {
  BadAtoms bad;
  std::string kept;
  kept.reserve(text.size());
  std::size_t number = 0;
  for (std::size_t at = 0, next = 0; at < text.size(); at = next) {
    next = std::min(text.find('\n', at), text.size() - 1) + 1;
    std::string_view line = std::string_view(text).substr(at, next - at);
    ++number;
    if (!line.starts_with("ATOM  ") && !line.starts_with("HETATM")) {
      kept.append(line);
      continue;
    }
    ++bad.all;
    const Position position = check_position(line);
    if (position == Position::kBad) {
      if (bad.count++ == 0) bad.first_line = number, bad.is_misplaced = has_numbers(line);
      if (bad.comma_line == 0 && has_decimal_commas(columns_of(line, kPosition, line.size()))) bad.comma_line = number;
      continue;
    }
    if (position == Position::kShifted && bad.shifted++ == 0) bad.first_shifted_line = number;
    if (!is_old(line)) {
      kept.append(line);
      continue;
    }
    kept.append(line.substr(0, kOld));
    kept.push_back('\n');
  }
  text = std::move(kept);
  return bad;
}

}  // namespace

Result<Scene> read_pdb(const std::filesystem::path& file, const std::optional<std::string>& field) {
  auto text = read_whole_file(file);
  if (!text) return text.error();
  text->erase(0, text->size() - without_mark(*text).size());  // columns count
  if (text->find('\n') == std::string::npos) std::replace(text->begin(), text->end(), '\r', '\n');
  const BadAtoms bad = clean_atoms(*text);
  if (bad.comma_line > 0) return decimal_commas_error(file.string(), bad.comma_line);
  const gemmi::Structure structure = gemmi::read_pdb_from_memory(text->data(), text->size(), file.string());
  std::vector<Atom> atoms;
  std::vector<FieldColumns> fields = field_columns(kAtomColumns, field);
  std::size_t chains = 0;
  if (!structure.models.empty())
    for (const gemmi::Chain& chain : structure.models[0].chains) {
      ++chains;
      for (const gemmi::Residue& residue : chain.first_conformer())
        for (const gemmi::Atom& atom : residue.first_conformer()) {
          atoms.push_back({{atom.pos.x, atom.pos.y, atom.pos.z}, atom.element.name()});
          const std::array<double, 6> values = {
              double(atom.b_iso),
              double(atom.occ),
              double(atom.charge),
              double(chains),
              residue.seqid.num.has_value() ? double(*residue.seqid.num) : std::nan(""),
              double(atom.element.atomic_number())};
          for (FieldColumns& each : fields) each.append([&](std::size_t k) { return values[k]; });
        }
    }
  if (atoms.empty() && bad.count > 0)
    return file_error("'{}' has no atom with three numbers in columns 31 to 54{}, first in line {}", file.string(),
                      bad.is_misplaced ? ": its columns are shifted" : "", bad.first_line);
  if (atoms.empty()) return file_error("'{}' has no atoms", file.string());
  Scene scene = scene_of_atoms(atoms, file);
  for (FieldColumns& each : fields) scene.meshes.at(0).fields.push_back(std::move(each.field));
  if (bad.count > 0)
    scene.warnings.push_back(
        fmt::format("{} of {} atoms have no position of three numbers{} and are left out, first in line {}", bad.count,
                    bad.all, bad.is_misplaced ? " in columns 31 to 54, but shifted," : "", bad.first_line));
  if (bad.shifted > 0)
    scene.warnings.push_back(
        fmt::format("{} of {} atoms seem to be shifted, since their numbers do not end in columns 38, 46 and 54, first "
                    "in line {}; their elements may be wrong",
                    bad.shifted, bad.all, bad.first_shifted_line));
  if (structure.models.size() > 1)
    scene.warnings.push_back(fmt::format("the file has {} models; the first is drawn", structure.models.size()));
  return scene;
}

}  // namespace umbrage
