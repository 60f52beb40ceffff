// Reads OFF in text form [Geomview, "Object File Format"]. Used instead of Assimp, since Assimp 5.2 reads neither
// colours of faces nor files without faces.
#include "scene/readers/model_readers.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/readers/polygon.h"
#include "scene/readers/positions.h"
#include "scene/readers/read_number.h"
#include "scene/readers/text_rules.h"
#include "scene/readers/vertex_colors.h"
#include "scene/readers/whole_file.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBlank = " \t\r\n", kLineEnd = "\r\n";

/// A reader of words and numbers; "#" starts a comment that extends to the end of the line.
struct Words {
  std::string_view text;
  bool failed = false;
  const char* comma = nullptr;  ///< the number at which it failed, if it has a decimal comma

  void skip() {
    while (true) {
      text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
      if (text.empty() || text[0] != '#') return;
      skip_line();
    }
  }

  std::string_view word() {
    skip();
    const std::string_view found = text.substr(0, text.find_first_of(" \t\r\n#"));
    text.remove_prefix(found.size());
    return found;
  }

  double number() {
    if (failed) return 0.0;
    const std::string_view found = word();
    const std::optional<double> value = number_of(found);
    failed = !value;
    if (failed && has_decimal_commas(found)) comma = found.data();
    return value.value_or(0.0);
  }

  std::size_t count() {
    const double value = number();
    failed = failed || !(value >= 0.0 && value < 4e9 && value == std::floor(value));
    return failed ? 0 : std::size_t(value);
  }

  /// Returns up to six numbers on the rest of the line, and moves to its end.
  std::vector<float> rest_of_line() {
    Words rest{text.substr(0, text.find_first_of(kLineEnd))};
    std::vector<float> numbers;
    constexpr std::size_t kMax = 6;
    while (numbers.size() < kMax) {
      const float value = float(rest.number());
      if (rest.failed) break;
      numbers.push_back(value);
    }
    if (rest.comma) failed = true, comma = rest.comma;
    skip_line();
    return numbers;
  }

  void skip_line() { text.remove_prefix(std::min(text.find_first_of(kLineEnd), text.size())); }
};

/// What follows a vertex's position.
struct Columns {
  bool normals = false, uvs = false, colors = false;
};

/// Reads vertices until the first that is not valid. Returns false if interrupted.
bool read_vertices(Words& words, Columns columns, std::size_t count, Mesh& mesh, Scene& scene, Poll* poll) {
  std::vector<glm::dvec3> positions;
  positions.reserve(count);
  bool is_assumed = false;  // the numbers after the position may be something else than colours
  for (std::size_t i = 0; i < count && !words.failed; ++i) {
    if (stops(poll, i, count)) return false;
    const double x = words.number(), y = words.number(), z = words.number();
    positions.emplace_back(x, y, z);
    if (columns.normals) {
      const float nx = float(words.number()), ny = float(words.number()), nz = float(words.number());
      mesh.normals.emplace_back(nx, ny, nz);
    }
    // Some programs write colours without a C in the first word.
    if (i == 0 && !columns.uvs && !columns.colors) {
      const std::size_t more = Words(words).rest_of_line().size();
      columns.colors = more == 3 || more == 4;
      is_assumed = columns.colors;
    }
    if (!columns.uvs && !columns.colors) {
      words.skip_line();
      continue;
    }
    // A colour of three or four numbers may follow; texture coordinates are the last two numbers of the line.
    std::vector<float> values = words.rest_of_line();
    const std::size_t found = values.size();
    values.resize(std::max<std::size_t>(3, found));
    if (columns.uvs) mesh.uvs.emplace_back(found > 1 ? values[found - 2] : 0.0f, found > 0 ? values[found - 1] : 0.0f);
    if (columns.colors) mesh.colors.emplace_back(values[0], values[1], values[2]);
  }
  // Colours are 0 to 1, or 0 to 255 if any value is above 1.
  float brightest = 0.0f, darkest = 0.0f;
  for (const glm::vec3& c : mesh.colors) {
    brightest = std::max({brightest, c.x, c.y, c.z});
    darkest = std::min({darkest, c.x, c.y, c.z});
  }
  if (is_assumed && darkest < 0.0f) mesh.colors.clear();
  for (glm::vec3& c : mesh.colors) c = linear_color(brightest > 1.0f ? c / 255.0f : c);
  set_positions(positions, mesh, scene);
  return true;
}

/// Colours of triangles, as in the file: 0 to 1, or 0 to 255 if any value is above 1.
struct FaceColors {
  std::vector<std::optional<glm::vec3>> colors;
  float brightest = 0.0f;
  bool any = false, any_index = false;

  void add(const std::vector<float>& numbers, std::size_t triangles) {
    std::optional<glm::vec3> color;
    if (numbers.size() == 3 || numbers.size() == 4) color = {numbers[0], numbers[1], numbers[2]};
    if (color) brightest = std::max({brightest, color->x, color->y, color->z});
    any = any || color;
    any_index = any_index || numbers.size() == 1;
    colors.insert(colors.end(), triangles, color);
  }
  std::vector<glm::vec3> linear() const {
    std::vector<glm::vec3> all;
    for (const auto& color : colors)
      all.push_back(color ? linear_color(brightest > 1.0f ? *color / 255.0f : *color) : Material().albedo);
    return all;
  }
};

/// Memory of read_face that is kept between faces.
struct FaceMemory {
  std::vector<std::uint32_t> corners;
  FaceSplitter splitter;
};

void read_face(Words& words, FaceMemory& memory, Mesh& mesh, FaceColors& colors) {
  auto& [corners, splitter] = memory;
  corners.clear();
  const std::size_t count = words.count();
  for (std::size_t k = 0; k < count && !words.failed; ++k) corners.push_back(std::uint32_t(words.count()));
  if (words.failed) return;
  const std::vector<std::uint32_t>& triangles = splitter.split(corners, mesh.positions);
  for (const std::uint32_t corner : triangles) mesh.indices.push_back(corners[corner]);
  colors.add(words.rest_of_line(), triangles.size() / 3);
}

}  // namespace

Result<Scene> read_off(const fs::path& path, Poll* poll) {
  const std::string file = path.string();
  const auto bytes = read_whole_file(path, poll);
  if (!bytes) return bytes.error();
  Words words{without_mark(*bytes)};
  words.skip();
  const std::size_t numbers = Words(words).rest_of_line().size();
  const bool begins_with_counts = numbers == 2 || numbers == 3;  // as some programs write it, without OFF
  std::string_view kind = begins_with_counts ? "OFF" : words.word();
  if (const std::size_t end = kind.find("OFF") + 3; end != std::string_view::npos + 3 && end < kind.size()) {
    words.text = {kind.data() + end, words.text.data() + words.text.size()};  // the counts follow without a blank
    kind = kind.substr(0, end);
  }
  if (!kind.ends_with("OFF") || kind.find_first_not_of("STCNOF") != std::string_view::npos) {
    return file_error("'{}' cannot be read as OFF (its first word is not OFF, COFF, NOFF or the like)", file);
  }
  const std::string_view prefix = kind.substr(0, kind.size() - 3);
  const bool has_normals = prefix.find('N') != std::string_view::npos;
  const bool has_uvs = prefix.starts_with("ST"), has_colors = prefix.find('C') != std::string_view::npos;
  words.skip();
  if (words.text.starts_with("BINARY")) return file_error("'{}' is a binary OFF file; only text can be read", file);

  // The counts of vertices and faces, and of edges, which is not used and may be missing: then the line ends.
  const std::size_t vertex_count = words.count();
  Words line{words.text.substr(0, words.text.find_first_of(kLineEnd))};
  const std::size_t face_count = words.count();
  if (line.word().empty())
    words.count();
  else
    words.skip_line();
  const auto cut_short = [&](const std::string& message) {
    return words.comma ? decimal_commas_error(file, line_number_at(*bytes, words.comma)) : file_error("{}", message);
  };
  // A vertex takes three numbers and a face at least one number, each followed by a blank.
  if (words.failed || vertex_count > words.text.size() / 6 + 1 || face_count > words.text.size() / 2 + 1) {
    return cut_short(fmt::format("'{}' is cut short, or its counts of vertices and faces are wrong", file));
  }
  Scene scene;
  scene.materials.emplace_back();
  Mesh mesh;
  mesh.name = path.stem().string();
  const Columns columns{.normals = has_normals, .uvs = has_uvs, .colors = has_colors};
  if (!read_vertices(words, columns, vertex_count, mesh, scene, poll)) return interrupted();
  if (words.failed) {
    return cut_short(fmt::format("'{}' is cut short, or has something other than a number, at vertex {} of {}", file,
                                 mesh.positions.size(), vertex_count));
  }
  FaceColors colors;
  FaceMemory memory{{}, FaceSplitter(poll)};
  std::size_t face = 0;
  for (; face < face_count && !words.failed; ++face) {
    if (stops(poll, face, face_count)) return interrupted();
    read_face(words, memory, mesh, colors);
  }
  if (words.failed)
    return cut_short(fmt::format("'{}' is cut short, or has something other than an index, at face {} of {}", file,
                                 face, face_count));
  if (begins_with_counts && !words.word().empty())
    return file_error("'{}' cannot be read as OFF (its first word is not OFF, and it has more rows than it counts)",
                      file);
  if (colors.any && mesh.colors.empty()) set_face_attributes({.uvs = {}, .colors = colors.linear()}, mesh);
  if (colors.any_index) scene.warnings.push_back("colours of faces that are numbers of a colour map are not drawn");
  mesh.points = face_count == 0;
  if (!mesh.colors.empty()) scene.materials[0].albedo = glm::vec3(1.0f);
  if (mesh.points || !mesh.indices.empty()) scene.meshes.push_back(std::move(mesh));
  return scene;
}

}  // namespace umbrage
