#include "scene/readers/molecule.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "core/lowercase.h"
#include "scene/readers/positions.h"
#include "scene/readers/read_number.h"
#include "scene/readers/text_rules.h"
#include "scene/readers/vertex_colors.h"
#include "scene/readers/whole_file.h"

namespace umbrage {
namespace {

// ---- chemical elements: colours and radii of their atoms

// Colours are those of Jmol (jmol.org, "Jmol colors"), radii those of [Alvarez 2013], table 1.

struct Element {
  glm::vec3 color;  ///< linear
  float radius;     ///< van der Waals radius, 1e-10 m
};

constexpr float kNoRadius = 2.0f;  // for elements without a measured radius

struct Row {
  const char* symbol;
  std::uint32_t rgb;  // sRGB
  float radius;
};

// clang-format off
constexpr Row kRows[] = {
    {"H", 0xffffff, 1.20f}, {"He", 0xd9ffff, 1.43f}, {"Li", 0xcc80ff, 2.12f}, {"Be", 0xc2ff00, 1.98f},
    {"B", 0xffb5b5, 1.91f}, {"C", 0x909090, 1.77f}, {"N", 0x3050f8, 1.66f}, {"O", 0xff0d0d, 1.50f},
    {"F", 0x90e050, 1.46f}, {"Ne", 0xb3e3f5, 1.58f}, {"Na", 0xab5cf2, 2.50f}, {"Mg", 0x8aff00, 2.51f},
    {"Al", 0xbfa6a6, 2.25f}, {"Si", 0xf0c8a0, 2.19f}, {"P", 0xff8000, 1.90f}, {"S", 0xffff30, 1.89f},
    {"Cl", 0x1ff01f, 1.82f}, {"Ar", 0x80d1e3, 1.83f}, {"K", 0x8f40d4, 2.73f}, {"Ca", 0x3dff00, 2.62f},
    {"Sc", 0xe6e6e6, 2.58f}, {"Ti", 0xbfc2c7, 2.46f}, {"V", 0xa6a6ab, 2.42f}, {"Cr", 0x8a99c7, 2.45f},
    {"Mn", 0x9c7ac7, 2.45f}, {"Fe", 0xe06633, 2.44f}, {"Co", 0xf090a0, 2.40f}, {"Ni", 0x50d050, 2.40f},
    {"Cu", 0xc88033, 2.38f}, {"Zn", 0x7d80b0, 2.39f}, {"Ga", 0xc28f8f, 2.32f}, {"Ge", 0x668f8f, 2.29f},
    {"As", 0xbd80e3, 1.88f}, {"Se", 0xffa100, 1.82f}, {"Br", 0xa62929, 1.86f}, {"Kr", 0x5cb8d1, 2.25f},
    {"Rb", 0x702eb0, 3.21f}, {"Sr", 0x00ff00, 2.84f}, {"Y", 0x94ffff, 2.75f}, {"Zr", 0x94e0e0, 2.52f},
    {"Nb", 0x73c2c9, 2.56f}, {"Mo", 0x54b5b5, 2.45f}, {"Tc", 0x3b9e9e, 2.44f}, {"Ru", 0x248f8f, 2.46f},
    {"Rh", 0x0a7d8c, 2.44f}, {"Pd", 0x006985, 2.15f}, {"Ag", 0xc0c0c0, 2.53f}, {"Cd", 0xffd98f, 2.49f},
    {"In", 0xa67573, 2.43f}, {"Sn", 0x668080, 2.42f}, {"Sb", 0x9e63b5, 2.47f}, {"Te", 0xd47a00, 1.99f},
    {"I", 0x940094, 2.04f}, {"Xe", 0x429eb0, 2.06f}, {"Cs", 0x57178f, 3.48f}, {"Ba", 0x00c900, 3.03f},
    {"La", 0x70d4ff, 2.98f}, {"Ce", 0xffffc7, 2.88f}, {"Pr", 0xd9ffc7, 2.92f}, {"Nd", 0xc7ffc7, 2.95f},
    {"Pm", 0xa3ffc7, kNoRadius}, {"Sm", 0x8fffc7, 2.90f}, {"Eu", 0x61ffc7, 2.87f}, {"Gd", 0x45ffc7, 2.83f},
    {"Tb", 0x30ffc7, 2.79f}, {"Dy", 0x1fffc7, 2.87f}, {"Ho", 0x00ff9c, 2.81f}, {"Er", 0x00e675, 2.83f},
    {"Tm", 0x00d452, 2.79f}, {"Yb", 0x00bf38, 2.80f}, {"Lu", 0x00ab24, 2.74f}, {"Hf", 0x4dc2ff, 2.63f},
    {"Ta", 0x4da6ff, 2.53f}, {"W", 0x2194d6, 2.57f}, {"Re", 0x267dab, 2.49f}, {"Os", 0x266696, 2.48f},
    {"Ir", 0x175487, 2.41f}, {"Pt", 0xd0d0e0, 2.29f}, {"Au", 0xffd123, 2.32f}, {"Hg", 0xb8b8d0, 2.45f},
    {"Tl", 0xa6544d, 2.47f}, {"Pb", 0x575961, 2.60f}, {"Bi", 0x9e4fb5, 2.54f}, {"Po", 0xab5c00, kNoRadius},
    {"At", 0x754f45, kNoRadius}, {"Rn", 0x428296, kNoRadius}, {"Fr", 0x420066, kNoRadius},
    {"Ra", 0x007d00, kNoRadius}, {"Ac", 0x70abfa, 2.80f}, {"Th", 0x00baff, 2.93f}, {"Pa", 0x00a1ff, 2.88f},
    {"U", 0x008fff, 2.71f}, {"Np", 0x0080ff, 2.82f}, {"Pu", 0x006bff, 2.81f}, {"Am", 0x545cf2, 2.83f},
    {"Cm", 0x785ce3, 3.05f}, {"Bk", 0x8a4fe3, 3.40f}, {"Cf", 0xa136d4, 3.05f}, {"Es", 0xb31fd4, 2.70f},
    {"Fm", 0xb31fba, kNoRadius}, {"Md", 0xb30da6, kNoRadius}, {"No", 0xbd0d87, kNoRadius},
    {"Lr", 0xc70066, kNoRadius}, {"Rf", 0xcc0059, kNoRadius}, {"Db", 0xd1004f, kNoRadius},
    {"Sg", 0xd90045, kNoRadius}, {"Bh", 0xe00038, kNoRadius}, {"Hs", 0xe6002e, kNoRadius},
    {"Mt", 0xeb0026, kNoRadius},
};
// clang-format on

/// Returns a reflectance. Jmol's colours are those of lit pixels; no surface reflects all of one colour and nothing of
/// the others, and pictures of such surfaces have no shades.
glm::vec3 reflectance(std::uint32_t rgb) {
  constexpr float kMin = 0.04f, kMax = 0.85f;
  const glm::vec3 color(float(rgb >> 16 & 255u), float(rgb >> 8 & 255u), float(rgb & 255u));
  return kMin + (kMax - kMin) * linear_color(color / 255.0f);
}

char upper(char c) { return char(std::toupper(static_cast<unsigned char>(c))); }

/// Returns all elements by their symbols in capitals.
const std::map<std::string, Element, std::less<>>& elements() {
  static const auto all = [] {
    std::map<std::string, Element, std::less<>> table;
    for (const Row& row : kRows) {
      std::string symbol = row.symbol;
      for (char& c : symbol) c = upper(c);
      table[symbol] = {reflectance(row.rgb), row.radius};
    }
    table["D"] = table["T"] = table["H"];
    return table;
  }();
  return all;
}

/// Returns the element that the one or two letters at the beginning of a word name, such as "C", "CL" or "Fe2+"; null
/// if there is none, or the word has more letters, or names a ghost or dummy atom. "D" and "T" are hydrogen.
const Element* find_element(std::string_view word) {
  std::string letters;
  for (const char c : word) {
    if (!std::isalpha(static_cast<unsigned char>(c)) || letters.size() == 3) break;
    letters += upper(c);
  }
  const auto found = [](const std::string& symbol) {
    const auto at = elements().find(symbol);
    return at == elements().end() ? nullptr : &at->second;
  };
  if (letters.empty() || letters.size() > 2 || letters == "BQ" || letters == "DU") return nullptr;
  if (const Element* whole = found(letters)) return whole;
  return found(letters.substr(0, 1));  // "OW": the oxygen of a water
}

/// Returns the symbol of an atomic number; empty if there is none.
std::string_view symbol_of(unsigned atomic_number) {
  return atomic_number >= 1 && atomic_number <= std::size(kRows) ? kRows[atomic_number - 1].symbol : "";
}

/// Returns the values for an atom of no known element.
const Element& unknown_element() {
  static const Element unknown{reflectance(0xff1493u), kNoRadius};  // Jmol's colour for them
  return unknown;
}

// ---- files

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

/// The places of an atom's columns in a line.
struct AtomColumns {
  std::size_t symbol = 0, position = 1;
};

/// Returns the columns that the second line of an extended XYZ file names, as Properties=species:S:1:pos:R:3; nothing
/// if they lack a symbol or a position. A line without them has the usual columns.
std::optional<AtomColumns> columns_of(std::string_view comment) {
  constexpr std::string_view kName = "properties=";
  const std::size_t at = lowercase(comment).find(kName);
  if (at == std::string_view::npos) return AtomColumns();
  comment.remove_prefix(at + kName.size());
  if (comment.starts_with('"')) comment.remove_prefix(1);
  comment = comment.substr(0, comment.find_first_of("\" \t"));
  const auto take_part = [&] {
    const std::string_view part = comment.substr(0, comment.find(':'));
    comment.remove_prefix(std::min(part.size() + 1, comment.size()));
    return part;
  };
  std::optional<std::size_t> symbol, number, position;
  for (std::size_t column = 0; !comment.empty();) {
    const std::string_view name = take_part();
    take_part();  // the type
    const auto count = integer_of<std::uint32_t>(take_part());
    if (!count) return std::nullopt;
    if (name == "species" || name == "element" || name == "symbol") symbol = column;
    if (name == "Z" || name == "numbers") number = column;
    if ((name == "pos" || name == "positions") && *count == 3) position = column;
    column += *count;
  }
  if (!symbol) symbol = number;
  return symbol && position ? std::optional(AtomColumns{*symbol, *position}) : std::nullopt;
}

bool begins_with_letter(std::string_view word) {
  return !word.empty() && std::isalpha(static_cast<unsigned char>(word[0]));
}

/// Returns the atom of a line: a word that begins with a letter, or an atomic number, and three numbers. An index may
/// be before the symbol, unless columns are named.
std::optional<Atom> atom_of(std::string_view line, AtomColumns columns = {}) {
  std::string_view symbol, after_index = line;
  if (integer_of<std::uint64_t>(take_column(after_index)) && begins_with_letter(take_column(after_index)) &&
      columns.position == 1)
    columns = {1, 2};
  std::array<std::string_view, 3> position;
  for (std::size_t i = 0; i < std::max(columns.symbol + 1, columns.position + 3); ++i) {
    const std::string_view word = take_column(line);
    if (word.empty()) return std::nullopt;
    if (i == columns.symbol) symbol = word;
    if (i >= columns.position && i < columns.position + 3) position[i - columns.position] = word;
  }
  Atom atom{glm::dvec3(0.0), std::string(symbol)};
  if (!begins_with_letter(symbol)) {
    const auto number = integer_of<unsigned>(symbol);
    atom.symbol = number ? symbol_of(*number) : "";
    if (atom.symbol.empty()) return std::nullopt;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const auto value = number_of(position[std::size_t(axis)]);
    if (!value || !std::isfinite(*value)) return std::nullopt;
    atom.position[axis] = *value;
  }
  return atom;
}

/// Returns the largest distance from some atoms to their nearest neighbours.
double neighbor_distance(const std::vector<glm::dvec3>& positions) {
  constexpr std::size_t kSamples = 32;
  double largest = 0.0;
  for (std::size_t i = 0; i < positions.size(); i += 1 + positions.size() / kSamples) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const glm::dvec3& p : positions)
      if (p != positions[i]) nearest = std::min(nearest, glm::distance(p, positions[i]));
    largest = std::max(largest, nearest);
  }
  return largest;
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
  constexpr double kShortest = 0.4;  // a bond of H2 is 0.74
  if (const double distance = neighbor_distance(positions); distance > 0.0 && distance < kShortest)
    scene.warnings.push_back(fmt::format(
        "neighbouring atoms are only {:.2g} apart: positions are probably in nm, but are read in angstrom", distance));
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
    const std::string_view whole = take_line(text);
    std::string_view row = whole;
    const auto atom = atom_of(row);
    const std::string_view word = take_column(row), next = take_column(row);
    // Atomic numbers in place of symbols, and symbols of no element, are known by the head of the file.
    const bool is_symbol = begins_with_letter(word) || begins_with_letter(next);
    if (atom && ((line == 2 && has_head) || (is_symbol && find_element(atom->symbol)))) return true;
    if (line == 0) has_head = integer_of<std::uint64_t>(word) && next.empty();
    if (line == 1) has_head = has_head && !number_of(word);
    if (line == 1 && has_head && lowercase(whole).find("properties=") != std::string::npos) return true;
  }
  return false;
}

Result<Scene> read_molecule(const fs::path& path, std::string_view text, Poll* poll) {
  const std::string file = path.string();
  std::string_view rest = without_mark(text);
  std::vector<Atom> atoms;
  std::size_t line = 0, bad = 0, first_bad = 0;
  std::optional<AtomColumns> columns = AtomColumns();
  std::string_view ahead = rest, first = take_line(ahead);
  const auto number = integer_of<std::uint64_t>(take_column(first));
  const bool has_count = number && take_column(first).empty();
  const std::uint64_t count = number.value_or(0);
  bool in_bohr = false;
  if (has_count) {
    rest = ahead;
    const std::string comment(take_line(rest)), words = lowercase(comment);
    in_bohr = words.find("unit") != std::string::npos && words.find("bohr") != std::string::npos;
    columns = columns_of(comment);
    if (!columns) return file_error("'{}' has no species and pos among its Properties, in line 2", file);
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
    if (row.find(',') != std::string_view::npos && has_decimal_commas(row)) return decimal_commas_error(file, line);
    if (auto atom = atom_of(row, *columns)) {
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
  if (in_bohr)
    for (Atom& atom : atoms) atom.position *= 0.529177;
  Scene scene = scene_of_atoms(atoms, path);
  if (in_bohr) scene.warnings.push_back("positions are in bohr, as line 2 says; they are converted to angstrom");
  if (bad > 0)
    scene.warnings.push_back(
        fmt::format("{} of {} lines lack an element or three numbers and are left out, first line {}", bad,
                    atoms.size() + bad, first_bad));
  rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n"), rest.size()));
  std::string_view next = take_line(rest);  // a frame begins with a count, other lines do not
  if (has_count && integer_of<std::uint64_t>(take_column(next)) && take_column(next).empty())
    scene.warnings.push_back("the file has more than one frame; the first is drawn");
  return scene;
}

}  // namespace umbrage
