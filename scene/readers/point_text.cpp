// Reader for points in text form. The header describes the columns.
#include "scene/readers/model_readers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/lists.h"
#include "core/lowercase.h"
#include "scene/readers/field_columns.h"
#include "scene/readers/molecule.h"
#include "scene/readers/positions.h"
#include "scene/readers/read_number.h"
#include "scene/readers/text_rules.h"
#include "scene/readers/vertex_colors.h"
#include "scene/readers/whole_file.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxColumns = 10;
constexpr std::size_t kMaxBad = 4;  // one line in four may be bad

/// The numbers of a line, up to the first word that is not a number.
struct Row {
  std::array<double, kMaxColumns> values{};
  std::size_t count = 0;
  bool all_numbers = true;
  bool may_have_decimal_commas = false;  ///< commas and other marks separate its numbers
};

bool is_separator(char c) { return c == ' ' || c == '\t' || c == '\r' || c == ',' || c == ';'; }  // kColumnBlank

Row row_of(std::string_view line) {
  Row row;
  const char *at = line.data(), *const end = at + line.size();
  bool has_comma = false, has_other = false;
  while (row.count < kMaxColumns) {
    const char* const start = at;
    while (at < end && is_separator(*at)) ++at;
    if (at == end || *at == '#') break;
    (at == start + 1 && *start == ',' ? has_comma : has_other) |= row.count > 0;
    double value = 0.0;
    row.all_numbers = read_number(at, end, value) && (at == end || *at == '#' || is_separator(*at));
    if (!row.all_numbers) break;
    row.values[row.count++] = value;
  }
  row.may_have_decimal_commas = has_comma && has_other;
  return row;
}

/// Calls visit(line, number) for each line, ended by LF, CR LF or CR; stops if it returns false.
template <class Visit>
void for_each_line(std::string_view text, Visit visit) {
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    if (!visit(text.substr(0, end), number)) return;
    const std::size_t breaks = text.substr(end).starts_with("\r\n") ? 2 : 1;
    text.remove_prefix(std::min(end + breaks, text.size()));
  }
}

glm::vec3 triple(const Row& row, std::size_t first) {
  return {float(row.values[first]), float(row.values[first + 1]), float(row.values[first + 2])};
}

/// Returns what a colour of 1 is in three columns: 1, or 255 or 65535 if they are integers, or 255 if they may have
/// `decimals`; 0 if they are no colours.
float color_scale(const std::vector<Row>& rows, std::size_t first, bool decimals) {
  double max = 0.0;
  bool is_whole = true;
  for (const Row& row : rows)
    for (std::size_t k = first; k < first + 3; ++k) {
      const double v = row.values[k];
      if (!(v >= 0.0)) return 0.0f;
      max = std::max(max, v);
      is_whole = is_whole && v == std::floor(v);
    }
  if (max <= 1.0) return 1.0f;
  if (max <= 255.0) return is_whole || decimals ? 255.0f : 0.0f;
  return is_whole && max <= 65535.0 ? 65535.0f : 0.0f;
}

bool are_normals(const std::vector<Row>& rows, std::size_t first) {
  constexpr float kTolerance = 0.02f;  // tolerance for numbers with two digits
  return std::all_of(rows.begin(), rows.end(),
                     [&](const Row& row) { return std::abs(glm::length(triple(row, first)) - 1.0f) < kTolerance; });
}

constexpr std::size_t kNoColumn = kMaxColumns;

/// The first of the three columns of colours and of normals; kNoColumn: there are none.
struct PointColumns {
  std::size_t color = kNoColumn, normal = kNoColumn;
  float color_scale = 0.0f;
};

/// Finds the columns of colours and normals from `first` on by their values. Integers above 255 are colours only if no
/// others are: they may be an intensity and two components. So are decimals above 1, and only without other columns.
PointColumns columns_by_values(const std::vector<Row>& rows, std::size_t first, std::size_t columns) {
  PointColumns out;
  for (const auto& [max_scale, decimals] : {std::pair(255.0f, false), {65535.0f, false}, {255.0f, true}}) {
    if (decimals && columns != first + (out.normal == kNoColumn ? 3 : 6)) break;
    for (std::size_t at = first; at + 3 <= columns; ++at) {
      if (at == out.color || at == out.normal) {
        at += 2;
        continue;
      }
      const float scale = out.color == kNoColumn ? color_scale(rows, at, decimals) : 0.0f;
      if (out.normal == kNoColumn && are_normals(rows, at))
        out.normal = at;
      else if (scale > 0.0f && scale <= max_scale)
        out.color = at, out.color_scale = scale;
      else
        continue;
      at += 2;
    }
  }
  return out;
}

Scene scene_of(Mesh mesh, const std::vector<glm::dvec3>& positions, const fs::path& file) {
  Scene scene;
  Material material;
  material.albedo = glm::vec3(mesh.colors.empty() ? 0.8f : 1.0f);
  scene.materials.push_back(material);
  mesh.name = file.stem().string();
  mesh.points = true;
  set_positions(positions, mesh, scene);
  if (!mesh.positions.empty()) scene.meshes.push_back(std::move(mesh));
  return scene;
}

/// What a line of column names says.
struct NamedColumns {
  std::vector<std::size_t> order;  ///< for each column of the file its place in a row; empty: no names
  std::vector<std::string> names;  ///< of the columns of ordered rows
  PointColumns columns;            ///< of ordered rows
};

/// Reads a line of column names: x, y and z come first in ordered rows, then colours and normals, then the rest. There
/// are no names if it does not have x, y and z.
NamedColumns columns_by_names(std::string_view line) {
  std::vector<std::string> names;
  constexpr std::string_view kMarks = " \t\r,;#/\"";
  while (true) {
    line.remove_prefix(std::min(line.find_first_not_of(kMarks), line.size()));
    const std::string_view word = line.substr(0, line.find_first_of(kMarks));
    if (word.empty()) break;
    line.remove_prefix(word.size());
    names.push_back(lowercase(word));
  }
  NamedColumns out;
  if (names.size() > kMaxColumns) return out;
  std::vector<std::size_t> order(names.size(), kNoColumn);
  std::size_t next = 0;
  const auto place = [&](std::initializer_list<const char*> triple) {
    std::vector<std::size_t> found;
    for (const char* name : triple)
      found.push_back(std::size_t(std::find(names.begin(), names.end(), name) - names.begin()));
    if (contains(found, names.size())) return kNoColumn;
    for (const std::size_t column : found) order[column] = next++;
    return next - 3;
  };
  if (place({"x", "y", "z"}) == kNoColumn) return out;
  out.columns.color = std::min(place({"r", "g", "b"}), place({"red", "green", "blue"}));
  out.columns.normal = std::min(place({"nx", "ny", "nz"}), place({"normal_x", "normal_y", "normal_z"}));
  for (std::size_t& column : order)
    if (column == kNoColumn) column = next++;
  out.names.resize(names.size());
  for (std::size_t k = 0; k < names.size(); ++k) out.names[order[k]] = std::move(names[k]);
  out.order = std::move(order);
  return out;
}

/// Puts the numbers of a row in their order, if it has as many as there are names, or a word in place of the next one.
Row ordered(const Row& row, const std::vector<std::size_t>& order) {
  if (row.count > order.size() || (row.count < order.size() && row.all_numbers)) return row;
  Row out = row;
  for (std::size_t i = 0; i < row.count; ++i) out.values[order[i]] = row.values[i];
  return out;
}

/// The rows of a file of points.
struct Rows {
  std::vector<Row> rows;
  std::size_t bad = 0, first_bad = 0;  ///< lines with fewer than three numbers, and the first of them
  std::size_t decimal_commas = 0;      ///< first line with numbers such as 0,5; 0: none
  NamedColumns named;
  double counted = 0.0;  ///< number of points by the lines that count them
};

Rows read_rows(std::string_view text, Poll* poll) {
  Rows out;
  for_each_line(text, [&](std::string_view line, std::size_t number) {
    constexpr std::size_t kLinesPerPoll = 4096;  // lines between calls of the poll
    if (poll && number % kLinesPerPoll == 0 && poll->passing(double(line.data() - text.data()) / double(text.size())))
      return false;
    if (out.rows.empty() && out.named.order.empty()) out.named = columns_by_names(line);
    line.remove_prefix(std::min(line.find_first_not_of(kColumnBlank), line.size()));
    if (line.empty() || line.starts_with('#') || line.starts_with("//")) return true;
    const Row row = row_of(line);
    if (row.count == 0 && out.rows.empty() && number == 1) return true;  // column names
    if (row.count == 1 && row.all_numbers) {                             // number of points, also of a further scan
      out.counted += double(row.values[0]);
      return true;
    }
    if (row.may_have_decimal_commas && has_decimal_commas(line)) {
      out.decimal_commas = number;
      return false;
    }
    if (row.count >= 3) {
      out.rows.push_back(ordered(row, out.named.order));
    } else if (out.bad++ == 0) {
      out.first_bad = number;
    }
    return true;
  });
  return out;
}

/// Returns the number of columns that most rows have, and drops rows with fewer, if they are few.
std::size_t common_columns(std::vector<Row>& rows) {
  std::array<std::size_t, kMaxColumns + 1> counts{};
  for (const Row& row : rows) ++counts[row.count];
  const std::size_t common = std::size_t(std::max_element(counts.begin(), counts.end()) - counts.begin());
  std::size_t columns = kMaxColumns, fewer = 0;
  for (const Row& row : rows) {
    columns = std::min(columns, row.count);
    fewer += row.count < common;
  }
  if (fewer == 0 || fewer * kMaxBad > rows.size()) return columns;
  std::erase_if(rows, [&](const Row& row) { return row.count < common; });
  return common;
}

/// Returns the fields that `wanted` asks for among the columns after the position.
std::vector<Field> fields_of(const std::vector<Row>& rows, const NamedColumns& named, const PointColumns& drawn,
                             std::size_t count, const std::optional<std::string>& wanted) {
  std::vector<FileColumn> columns(count);
  for (std::size_t k = 0; k < count; ++k) {
    const auto is_in = [&](std::size_t triple) { return k >= triple && k < triple + 3; };
    columns[k] = {k < named.names.size() ? named.names[k] : fmt::format("column {}", k + 1),
                  k >= 3 && !is_in(drawn.normal) && !(drawn.color_scale > 0.0f && is_in(drawn.color))};
  }
  std::vector<Field> fields;
  for (FieldColumns& each : field_columns(columns, wanted)) {
    for (const Row& row : rows) each.append([&](std::size_t k) { return row.values[k]; });
    fields.push_back(std::move(each.field));
  }
  return fields;
}

/// Adds a warning about columns that are not drawn. An intensity beside colours is no loss.
void warn_of_columns(const NamedColumns& named, const PointColumns& columns, std::size_t first, std::size_t count,
                     std::vector<std::string>& warnings) {
  const bool has_names = named.order.size() >= count;
  std::vector<std::string> lost;
  for (std::size_t k = first; k < count; ++k) {
    const auto is_in = [&](std::size_t triple) { return k >= triple && k < triple + 3; };
    if (is_in(columns.normal) || (columns.color_scale > 0.0f && is_in(columns.color))) continue;
    if (!has_names)
      lost.push_back(std::to_string(k + 1));
    else if (!columns.color_scale || (named.names[k] != "i" && named.names[k] != "intensity"))
      lost.push_back("'" + named.names[k] + "'");
  }
  if (lost.empty()) return;
  warnings.push_back(fmt::format("not drawn: {}{}{}; `color_by` shows values as colours", has_names ? "" : "column ",
                                 fmt::join(lost, ", "),
                                 has_names ? "" : "; a first line such as 'x y z r g b nx ny nz' names the columns"));
}

}  // namespace

Result<Scene> read_xyz(const fs::path& path, const std::optional<std::string>& field, Poll* poll) {
  const std::string file = path.string();
  const auto bytes = read_whole_file(path, poll);
  if (!bytes) return bytes.error();
  const std::string_view text = without_mark(*bytes);
  if (is_molecule(text)) return read_molecule(path, text, poll);
  Rows read = read_rows(text, poll);
  std::vector<Row>& rows = read.rows;
  const std::size_t bad = read.bad, first_bad = read.first_bad;
  if (poll && poll->ended()) return interrupted();
  if (read.decimal_commas > 0) return decimal_commas_error(file, read.decimal_commas);
  if (bad > 0 && bad * kMaxBad > rows.size() + bad)
    return file_error("'{}' has fewer than three numbers in line {}", file, first_bad);
  std::vector<std::string> warnings;
  if (bad > 0)
    warnings.push_back(fmt::format("{} of {} lines have fewer than three numbers and are left out, first line {}", bad,
                                   rows.size() + bad, first_bad));
  if (read.counted > double(rows.size() + bad))
    warnings.push_back(fmt::format("the file counts {} points, but has {}", read.counted, rows.size() + bad));
  const std::size_t before = rows.size(), count = common_columns(rows);
  if (rows.size() < before)
    warnings.push_back(
        fmt::format("{} of {} lines have fewer columns than others and are left out", before - rows.size(), before));
  PointColumns columns = read.named.columns;
  const auto is_there = [&](std::size_t first) { return first + 3 <= count; };
  std::size_t first = 3;
  if (read.named.order.size() < count) {
    // In .pts files an intensity comes between position and colour.
    constexpr std::size_t kWithIntensity = 7;
    first += count == kWithIntensity && lowercase(without_gz(path).extension().string()) == ".pts";
    columns = columns_by_values(rows, first, count);
  } else if (is_there(columns.color)) {
    columns.color_scale = color_scale(rows, columns.color, true);
  }
  constexpr std::size_t kManyRows = 10;
  const auto breaks_count = [](const Row& a, const Row& b) { return b.values[0] != a.values[0] + 1.0; };
  if (read.named.order.empty() && count > 3 && rows.size() >= kManyRows &&
      std::adjacent_find(rows.begin(), rows.end(), breaks_count) == rows.end())
    warnings.push_back(
        "column 1 counts the lines and is drawn as x; if it is an index, name it in a first line such as "
        "'i x y z'");
  if (!field) warn_of_columns(read.named, columns, first, count, warnings);
  Mesh mesh;
  mesh.fields = fields_of(rows, read.named, columns, count, field);
  if (is_there(columns.normal))
    for (const Row& row : rows) mesh.normals.push_back(triple(row, columns.normal));
  if (columns.color_scale > 0.0f)
    for (const Row& row : rows) mesh.colors.push_back(linear_color(triple(row, columns.color) / columns.color_scale));
  std::vector<glm::dvec3> positions;
  positions.reserve(rows.size());
  for (const Row& row : rows) positions.emplace_back(row.values[0], row.values[1], row.values[2]);
  Scene scene = scene_of(std::move(mesh), positions, path);
  scene.warnings = std::move(warnings);
  return scene;
}

}  // namespace umbrage
