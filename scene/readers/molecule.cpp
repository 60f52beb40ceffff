#include "scene/readers/molecule.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>

#include "scene/readers/byte_order_mark.h"
#include "scene/readers/elements.h"
#include "scene/readers/positions.h"
#include "scene/readers/read_number.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

/// Removes the first word of a line and returns it.
std::string_view take_column(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(kColumnBlank), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kColumnBlank));
  line.remove_prefix(word.size());
  return word;
}

std::string_view take_line(std::string_view& text) {
  const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
  const std::string_view line = text.substr(0, end);
  const std::size_t breaks = end + 1 < text.size() && text[end] == '\r' && text[end + 1] == '\n' ? 2 : 1;
  text.remove_prefix(std::min(end + breaks, text.size()));
  return line;
}

template <class T>
std::optional<T> integer_of(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  T value{};
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || stop != word.data() + word.size()) return std::nullopt;
  return value;
}

/// Returns the atom of a line: a word that begins with a letter, or an atomic number, and three numbers.
std::optional<Atom> atom_of(std::string_view line) {
  const std::string_view symbol = take_column(line);
  if (symbol.empty()) return std::nullopt;
  Atom atom{glm::dvec3(0.0), std::string(symbol)};
  if (!std::isalpha(static_cast<unsigned char>(symbol[0]))) {
    const auto number = integer_of<unsigned>(symbol);
    atom.symbol = number ? symbol_of(*number) : "";
    if (atom.symbol.empty()) return std::nullopt;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const auto value = number_of(take_column(line));
    if (!value || !std::isfinite(*value)) return std::nullopt;
    atom.position[axis] = *value;
  }
  return atom;
}

}  // namespace

Scene scene_of_atoms(const std::vector<Atom>& atoms, const fs::path& file) {
  Scene scene;
  scene.materials.emplace_back().albedo = glm::vec3(1.0f);
  Mesh mesh;
  mesh.name = file.stem().string();
  mesh.points = mesh.spheres = true;
  std::vector<glm::dvec3> positions;
  std::set<std::string> unknown;
  constexpr std::size_t kMaxLength = 8;
  for (const Atom& atom : atoms) {
    const Element* element = find_element(atom.symbol);
    if (!element) {
      unknown.insert(atom.symbol.substr(0, kMaxLength));
      element = &unknown_element();
    }
    positions.push_back(atom.position);
    mesh.colors.push_back(element->color);
    mesh.radii.push_back(element->radius);
  }
  set_positions(positions, mesh, scene);
  if (!mesh.positions.empty()) scene.meshes.push_back(std::move(mesh));
  if (!unknown.empty()) {
    constexpr std::size_t kMaxShown = 8;
    while (unknown.size() > kMaxShown) unknown.erase(std::prev(unknown.end()));
    scene.warnings.push_back(
        fmt::format("atoms of no known element are drawn in pink: '{}'", fmt::join(unknown, "', '")));
  }
  return scene;
}

bool is_molecule(std::string_view text) {
  text = without_mark(text);
  constexpr int kLines = 3;  // a count, a comment, the first atom
  bool has_head = false;     // a count alone in the first line, and a comment that does not begin with a number
  for (int line = 0; line < kLines && !text.empty(); ++line) {
    std::string_view row = take_line(text);
    const auto atom = atom_of(row);
    const std::string_view word = take_column(row);
    const bool is_symbol = !word.empty() && std::isalpha(static_cast<unsigned char>(word[0]));
    // Atomic numbers in place of symbols are known by the head of the file.
    if (atom && find_element(atom->symbol) && (is_symbol || (line == 2 && has_head))) return true;
    if (line == 0) has_head = integer_of<std::uint64_t>(word) && take_column(row).empty();
    if (line == 1) has_head = has_head && !number_of(word);
  }
  return false;
}

Result<Scene> read_molecule(const fs::path& path, std::string_view text, Poll* poll) {
  const std::string file = path.string();
  std::string_view rest = without_mark(text);
  std::vector<Atom> atoms;
  std::size_t line = 0, bad = 0, first_bad = 0;
  std::string_view ahead = rest, first = take_line(ahead);
  const auto number = integer_of<std::uint64_t>(take_column(first));
  const bool has_count = number && take_column(first).empty();
  const std::uint64_t count = number.value_or(0);
  if (has_count) {
    rest = ahead;
    take_line(rest);  // the comment, which may be empty
    line = 2;
  }
  const auto is_complete = [&] { return has_count && atoms.size() + bad >= count; };
  while (!rest.empty() && !is_complete()) {
    ++line;
    constexpr std::size_t kLinesPerPoll = 4096;
    if (poll && line % kLinesPerPoll == 0 && poll->passing(1.0 - double(rest.size()) / double(text.size())))
      return interrupted();
    std::string_view row = take_line(rest), words = row;
    const std::string_view word = take_column(words);
    if (word.empty() || word.starts_with('#')) continue;
    if (auto atom = atom_of(row)) {
      atoms.push_back(std::move(*atom));
    } else {
      if (bad++ == 0) first_bad = line;
    }
  }
  constexpr std::size_t kMaxBad = 3;  // one in four of all
  if (bad * kMaxBad > atoms.size())
    return file_error("'{}' has no element and three numbers in line {}", file, first_bad);
  if (has_count && !is_complete())
    return file_error("'{}' is cut short: it counts {} atoms and has {}", file, count, atoms.size() + bad);
  Scene scene = scene_of_atoms(atoms, path);
  if (bad > 0)
    scene.warnings.push_back(
        fmt::format("{} of {} lines lack an element or three numbers and are left out, first line {}", bad,
                    atoms.size() + bad, first_bad));
  if (has_count && rest.find_first_not_of(" \t\r\n") != std::string_view::npos)
    scene.warnings.push_back("the file has more than one frame; the first is drawn");
  return scene;
}

}  // namespace umbrage
