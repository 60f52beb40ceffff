// Reads OFF in text form [Geomview, "Object File Format"]. Used instead of Assimp, since Assimp 5.2 ends the program on
// some files with wrong counts.
#include "scene/readers/off.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include "scene/readers/vertex_colors.h"
#include "scene/readers/whole_file.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBlank = " \t\r\n";

/// A reader of words and numbers; "#" starts a comment that extends to the end of the line.
struct Words {
  std::string_view text;
  bool failed = false;

  void skip() {
    while (true) {
      text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
      if (text.empty() || text[0] != '#') return;
      text.remove_prefix(std::min(text.find('\n'), text.size()));
    }
  }

  std::string_view word() {
    skip();
    const std::string_view found = text.substr(0, text.find_first_of(kBlank));
    text.remove_prefix(found.size());
    return found;
  }

  double number() {
    if (failed) return 0.0;
    std::string_view found = word();
    if (found.starts_with('+')) found.remove_prefix(1);
    double value = 0.0;
    const auto [stop, error] = std::from_chars(found.data(), found.data() + found.size(), value);
    if (error == std::errc::result_out_of_range) value = INFINITY;
    failed = found.empty() || stop != found.data() + found.size();
    return value;
  }

  std::size_t count() {
    const double value = number();
    failed = failed || !(value >= 0.0 && value < 4e9 && value == std::floor(value));
    return failed ? 0 : std::size_t(value);
  }

  void skip_line() { text.remove_prefix(std::min(text.find('\n'), text.size())); }
};

}  // namespace

Result<Scene> read_off(const fs::path& path, Poll* poll) {
  const std::string file = path.string();
  const auto bytes = read_whole_file(path, poll);
  if (!bytes) return bytes.error();
  Words words{*bytes};
  std::string_view kind = words.word();
  if (!kind.ends_with("OFF") || kind.find_first_not_of("STCNOF") != std::string_view::npos) {
    return file_error("'{}' cannot be read as OFF (its first word is not OFF, COFF, NOFF or the like)", file);
  }
  const std::string_view prefix = kind.substr(0, kind.size() - 3);
  const bool has_normals = prefix.find('N') != std::string_view::npos;
  const bool has_uvs = prefix.starts_with("ST"), has_colors = prefix.find('C') != std::string_view::npos;
  words.skip();
  if (words.text.starts_with("BINARY")) return file_error("'{}' is a binary OFF file; only text can be read", file);

  const std::size_t vertex_count = words.count(), face_count = words.count();
  words.count();  // number of edges, not used
  // A vertex takes three numbers and a face at least one number, each followed by a blank.
  if (words.failed || vertex_count > words.text.size() / 6 + 1 || face_count > words.text.size() / 2 + 1) {
    return file_error("'{}' is cut short, or its counts of vertices and faces are wrong", file);
  }
  Scene scene;
  Mesh mesh;
  mesh.name = path.stem().string();
  mesh.positions.reserve(vertex_count);
  for (std::size_t i = 0; i < vertex_count && !words.failed; ++i) {
    if (stops(poll, i, vertex_count)) return interrupted();
    const float x = float(words.number()), y = float(words.number()), z = float(words.number());
    mesh.positions.emplace_back(x, y, z);
    if (has_normals) {
      const float nx = float(words.number()), ny = float(words.number()), nz = float(words.number());
      mesh.normals.emplace_back(nx, ny, nz);
    }
    // A colour of three or four numbers may follow; texture coordinates are the last two numbers of the line.
    const std::size_t line_end = std::min(words.text.find('\n'), words.text.size());
    Words rest{words.text.substr(0, line_end)};
    std::array<float, 6> values{};
    std::size_t count = 0;
    while ((has_uvs || has_colors) && count < values.size()) {
      const float value = float(rest.number());
      if (rest.failed) break;
      values[count++] = value;
    }
    if (has_uvs) mesh.uvs.emplace_back(count > 1 ? values[count - 2] : 0.0f, count > 0 ? values[count - 1] : 0.0f);
    if (has_colors) mesh.colors.emplace_back(values[0], values[1], values[2]);
    words.skip_line();
  }
  // Colours are 0 to 1, or 0 to 255 if any value is above 1.
  float brightest = 0.0f;
  for (const glm::vec3& c : mesh.colors) brightest = std::max({brightest, c.x, c.y, c.z});
  for (glm::vec3& c : mesh.colors) c = linear_color(brightest > 1.0f ? c / 255.0f : c);
  if (words.failed) {
    return file_error("'{}' is cut short, or has something other than a number, at vertex {} of {}", file,
                      mesh.positions.size(), vertex_count);
  }
  for (std::size_t i = 0; i < face_count; ++i) {
    if (stops(poll, i, face_count)) return interrupted();
    const std::size_t corners = words.count();
    std::uint32_t first = 0, previous = 0;
    for (std::size_t k = 0; k < corners && !words.failed; ++k) {
      const std::uint32_t corner = std::uint32_t(words.count());
      if (k == 0) first = corner;
      if (k >= 2) mesh.indices.insert(mesh.indices.end(), {first, previous, corner});
      previous = corner;
    }
    if (words.failed) {
      return file_error("'{}' is cut short, or has something other than an index, at face {} of {}", file, i + 1,
                        face_count);
    }
    words.skip_line();
  }
  mesh.points = face_count == 0;
  scene.materials.emplace_back();
  if (!mesh.colors.empty()) scene.materials[0].albedo = glm::vec3(1.0f);
  if (mesh.points || !mesh.indices.empty()) scene.meshes.push_back(std::move(mesh));
  return scene;
}

}  // namespace umbrage
