// Reader for points in text form. The header describes the columns.
#include "core/lowercase.h"
#include "scene/readers/model_readers.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>
#include <string_view>

#include "scene/readers/molecule.h"
#include "scene/readers/positions.h"
#include "scene/readers/read_number.h"
#include "scene/readers/vertex_colors.h"
#include "scene/readers/whole_file.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxColumns = 10;
constexpr std::size_t kMaxBad = 4;  // one line in four may be bad

/// The numbers of a line, up to the first word that is not a number.
struct Row {
  glm::dvec3 position{0.0};
  std::array<float, kMaxColumns> values{};
  std::size_t count = 0;
  bool all_numbers = true;
};

Row row_of(std::string_view line) {
  Row row;
  while (row.count < kMaxColumns) {
    line.remove_prefix(std::min(line.find_first_not_of(kColumnBlank), line.size()));
    if (line.empty()) break;
    double value = 0.0;
    const char *stop = line.data(), *const end = stop + line.size();
    row.all_numbers =
        read_number(stop, end, value) && (stop == end || kColumnBlank.find(*stop) != std::string_view::npos);
    if (!row.all_numbers) break;
    if (row.count < 3) row.position[int(row.count)] = value;
    row.values[row.count++] = float(value);
    line.remove_prefix(std::size_t(stop - line.data()));
  }
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
  return {row.values[first], row.values[first + 1], row.values[first + 2]};
}

bool is_color(const Row& row, std::size_t first) {
  return std::all_of(&row.values[first], &row.values[first] + 3,
                     [](float v) { return v >= 0.0f && v <= 255.0f && v == std::floor(v); });
}

bool is_normal(const Row& row, std::size_t first) {
  constexpr float kTolerance = 0.02f;  // tolerance for numbers with two digits
  return std::abs(glm::length(triple(row, first)) - 1.0f) < kTolerance;
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

/// Returns for each column of the file the column of a row that takes its number, so that x, y and z come first: from a
/// line of column names. Empty if the line has no such names, or the columns are in this order.
std::vector<std::size_t> order_of(std::string_view line) {
  std::vector<std::string> names;
  constexpr std::string_view kMarks = " \t\r,;#/\"";
  while (true) {
    line.remove_prefix(std::min(line.find_first_not_of(kMarks), line.size()));
    const std::string_view word = line.substr(0, line.find_first_of(kMarks));
    if (word.empty()) break;
    line.remove_prefix(word.size());
    names.push_back(lowercase(word));
  }
  std::vector<std::size_t> first;
  for (const char* axis : {"x", "y", "z"}) {
    const auto found = std::find(names.begin(), names.end(), axis);
    if (found == names.end()) return {};
    first.push_back(std::size_t(found - names.begin()));
  }
  if (first == std::vector<std::size_t>{0, 1, 2} || names.size() > kMaxColumns) return {};
  std::vector<std::size_t> order(names.size());
  std::size_t next = 3;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto at = std::find(first.begin(), first.end(), i);
    order[i] = at != first.end() ? std::size_t(at - first.begin()) : next++;
  }
  return order;
}

Row ordered(const Row& row, const std::vector<std::size_t>& order, std::string_view line) {
  if (order.empty() || row.count != order.size()) return row;
  // The positions again, as doubles of other columns.
  Row out = row;
  std::size_t column = 0;
  for (const std::size_t to : order) {
    line.remove_prefix(std::min(line.find_first_not_of(kColumnBlank), line.size()));
    const std::string_view word = line.substr(0, line.find_first_of(kColumnBlank));
    line.remove_prefix(word.size());
    const Row single = row_of(word);
    out.values[to] = row.values[column++];
    if (to < 3) out.position[int(to)] = single.position.x;
  }
  return out;
}

/// The rows of a file of points.
struct Rows {
  std::vector<Row> rows;
  std::size_t bad = 0, first_bad = 0;  ///< lines with fewer than three numbers, and the first of them
  std::size_t decimal_commas = 0;      ///< first line with numbers such as 0,5; 0: none
  double counted = 0.0;                ///< number of points by the lines that count them
};

/// Returns whether blanks separate the numbers of a line and commas are decimal points, as in "0,5 1,0 2,5".
bool has_decimal_commas(std::string_view line) {
  if (line.find(',') == std::string_view::npos || line.find('.') != std::string_view::npos) return false;
  const auto is_digit = [&](std::size_t i) {
    return i < line.size() && std::isdigit(static_cast<unsigned char>(line[i]));
  };
  bool within = false, between = false;
  for (std::size_t i = 1; i + 1 < line.size(); ++i) {
    if (!is_digit(i - 1)) continue;
    within = within || (line[i] == ',' && is_digit(i + 1));
    between = between || ((line[i] == ' ' || line[i] == '\t') && (is_digit(i + 1) || line[i + 1] == '-'));
  }
  return within && between;
}

Rows read_rows(std::string_view text, Poll* poll) {
  Rows out;
  std::vector<std::size_t> order;
  for_each_line(text, [&](std::string_view line, std::size_t number) {
    constexpr std::size_t kLinesPerPoll = 4096;  // lines between calls of the poll
    if (poll && number % kLinesPerPoll == 0 && poll->passing(double(line.data() - text.data()) / double(text.size())))
      return false;
    if (out.rows.empty() && order.empty()) order = order_of(line);
    line.remove_prefix(std::min(line.find_first_not_of(kColumnBlank), line.size()));
    if (line.empty() || line.starts_with('#') || line.starts_with("//")) return true;
    const Row row = row_of(line);
    if (row.count == 0 && out.rows.empty() && number == 1) return true;  // column names
    if (row.count == 1 && row.all_numbers) {                             // number of points, also of a further scan
      out.counted += double(row.values[0]);
      return true;
    }
    constexpr std::size_t kTestedLines = 16;
    if (out.rows.size() < kTestedLines && has_decimal_commas(line)) {
      out.decimal_commas = number;
      return false;
    }
    if (row.count >= 3) {
      out.rows.push_back(ordered(row, order, line));
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

}  // namespace

Result<Scene> read_xyz(const fs::path& path, Poll* poll) {
  const std::string file = path.string();
  const auto bytes = read_whole_file(path, poll);
  if (!bytes) return bytes.error();
  const std::string_view text = without_mark(*bytes);
  if (is_molecule(text)) return read_molecule(path, text, poll);
  Rows read = read_rows(text, poll);
  std::vector<Row>& rows = read.rows;
  const std::size_t bad = read.bad, first_bad = read.first_bad;
  if (poll && poll->ended()) return interrupted();
  if (read.decimal_commas > 0)
    return file_error("'{}' has decimal commas, as in line {}; write decimal points", file, read.decimal_commas);
  if (bad > 0 && bad * kMaxBad > rows.size() + bad)
    return file_error("'{}' has fewer than three numbers in line {}", file, first_bad);
  std::vector<std::string> warnings;
  if (bad > 0)
    warnings.push_back(fmt::format("{} of {} lines have fewer than three numbers and are left out, first line {}", bad,
                                   rows.size() + bad, first_bad));
  if (read.counted > double(rows.size() + bad))
    warnings.push_back(fmt::format("the file counts {} points, but has {}", read.counted, rows.size() + bad));
  const std::size_t before = rows.size(), columns = common_columns(rows);
  if (rows.size() < before)
    warnings.push_back(
        fmt::format("{} of {} lines have fewer columns than others and are left out", before - rows.size(), before));
  Mesh mesh;
  // An intensity may come between position and colour.
  for (std::size_t first = 3; first + 3 <= columns; ++first) {
    const auto all_rows = [&](auto test) {
      return std::all_of(rows.begin(), rows.end(), [&](const Row& row) { return test(row, first); });
    };
    if (mesh.normals.empty() && all_rows(is_normal)) {
      for (const Row& row : rows) mesh.normals.push_back(triple(row, first));
    } else if (mesh.colors.empty() && all_rows(is_color)) {
      for (const Row& row : rows) mesh.colors.push_back(linear_color(triple(row, first) / 255.0f));
    } else {
      continue;
    }
    first += 2;
  }
  std::vector<glm::dvec3> positions;
  positions.reserve(rows.size());
  for (const Row& row : rows) positions.push_back(row.position);
  Scene scene = scene_of(std::move(mesh), positions, path);
  scene.warnings = std::move(warnings);
  return scene;
}

}  // namespace umbrage
