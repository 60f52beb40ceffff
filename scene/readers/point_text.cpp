// Readers for points in text form. The header describes the columns.
#include "scene/readers/point_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>
#include <string_view>

#include "scene/readers/vertex_colors.h"
#include "scene/readers/whole_file.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxColumns = 10;
constexpr std::string_view kBlank = " \t\r,;";

/// The numbers of a line, up to the first word that is not a number.
struct Row {
  std::array<float, kMaxColumns> values{};
  std::size_t count = 0;
  bool all_numbers = true;
};

Row row_of(std::string_view line) {
  Row row;
  while (row.count < kMaxColumns) {
    line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
    if (line.empty()) break;
    if (line.front() == '+') line.remove_prefix(1);
    float value = 0.0f;
    const auto [stop, error] = std::from_chars(line.data(), line.data() + line.size(), value);
    row.all_numbers =
        stop != line.data() && (stop == line.data() + line.size() || kBlank.find(*stop) != std::string_view::npos);
    if (!row.all_numbers) break;
    row.values[row.count++] = error == std::errc::result_out_of_range ? INFINITY : value;
    line.remove_prefix(std::size_t(stop - line.data()));
  }
  return row;
}

/// Calls visit(line, number) for each line; stops if it returns false.
template <class Visit>
void for_each_line(std::string_view text, Visit visit) {
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    if (!visit(text.substr(0, end), number)) return;
    text.remove_prefix(std::min(end + 1, text.size()));
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

Scene scene_of(Mesh mesh, const fs::path& file) {
  Scene scene;
  Material material;
  material.albedo = glm::vec3(mesh.colors.empty() ? 0.8f : 1.0f);
  scene.materials.push_back(material);
  mesh.name = file.stem().string();
  mesh.points = true;
  if (!mesh.positions.empty()) scene.meshes.push_back(std::move(mesh));
  return scene;
}

}  // namespace

Result<Scene> read_xyz(const fs::path& path, Poll* poll) {
  const std::string file = path.string();
  const auto text = read_whole_file(path, poll);
  if (!text) return text.error();
  std::vector<Row> rows;
  std::size_t wrong_line = 0;
  for_each_line(*text, [&](std::string_view line, std::size_t number) {
    constexpr std::size_t kLinesPerPoll = 4096;  // lines between calls of the poll
    if (poll && number % kLinesPerPoll == 0 && poll->passing(double(line.data() - text->data()) / double(text->size())))
      return false;
    line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
    if (line.empty() || line.starts_with('#') || line.starts_with("//")) return true;
    const Row row = row_of(line);
    if (row.count < 3 && rows.empty() && number == 1) return true;  // number of points, or column names
    if (row.count < 3) {
      wrong_line = number;
      return false;
    }
    rows.push_back(row);
    return true;
  });
  if (poll && poll->ended()) return interrupted();
  if (wrong_line > 0) return file_error("'{}' has fewer than three numbers in line {}", file, wrong_line);

  Mesh mesh;
  std::size_t columns = kMaxColumns;
  for (const Row& row : rows) columns = std::min(columns, row.count);
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
  for (const Row& row : rows) mesh.positions.push_back(triple(row, 0));
  return scene_of(std::move(mesh), path);
}

bool is_obj_of_points(std::string_view text) {
  if (text.find("\nf ") != std::string_view::npos) return false;  // quick test for most files
  bool vertices = false, has_others = false;
  for_each_line(text, [&](std::string_view line, std::size_t) {
    line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
    const std::string_view word = line.substr(0, line.find_first_of(kBlank));
    vertices = vertices || word == "v";
    has_others = word == "f" || word == "l" || word == "fo" || word == "curv" || word == "surf";
    return !has_others;
  });
  return vertices && !has_others;
}

Result<Scene> read_obj_points(const fs::path& path, std::string_view text) {
  Mesh mesh;
  std::size_t wrong_line = 0;
  std::vector<glm::vec3> normals;
  for_each_line(text, [&](std::string_view line, std::size_t number) {
    line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
    const std::string_view word = line.substr(0, line.find_first_of(kBlank));
    if (word != "v" && word != "vn") return true;
    const Row row = row_of(line.substr(word.size()));
    if (row.count < 3) {
      wrong_line = number;
      return false;
    }
    if (word == "vn") {
      normals.push_back(triple(row, 0));
      return true;
    }
    mesh.positions.push_back(triple(row, 0));
    if (row.count >= 6) mesh.colors.push_back(triple(row, 3));
    return true;
  });
  if (wrong_line > 0) return file_error("'{}' has fewer than three numbers in line {}", path.string(), wrong_line);
  if (normals.size() == mesh.positions.size()) mesh.normals = std::move(normals);
  if (mesh.colors.size() != mesh.positions.size()) mesh.colors.clear();
  for (glm::vec3& color : mesh.colors) color = linear_color(color);
  return scene_of(std::move(mesh), path);
}

}  // namespace umbrage
