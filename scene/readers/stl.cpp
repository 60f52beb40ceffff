// Reads STL [3D Systems 1989]. Used instead of Assimp, since Assimp 5.2 refuses bytes after the last triangle, reads
// Magics' colours the wrong way round, and does not know keywords in capitals.
#include "core/lowercase.h"
#include "scene/readers/model_readers.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "scene/readers/positions.h"
#include "scene/readers/read_number.h"
#include "scene/readers/text_rules.h"
#include "scene/readers/vertex_colors.h"
#include "scene/readers/whole_file.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

// A binary file: a header, the number of triangles, and for each triangle a normal, three vertices and an attribute.
constexpr std::size_t kHeaderLength = 80, kStart = 84, kRow = 50, kVerticesInRow = 12, kAttributeInRow = 48;

template <class T>
T number_at(const char* bytes) {  // little-endian, as this program's machines are
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

/// Compares with a word in lower case.
bool same_word(std::string_view word, std::string_view lower_case) {
  return std::equal(word.begin(), word.end(), lower_case.begin(), lower_case.end(),
                    [](char a, char b) { return lowercase(a) == b; });
}

/// Returns whether the file is a text: its first bytes have words of a text file, and no zeros, as the count and the
/// attributes of a binary file, whose header may begin with "solid", too, would.
bool is_text(std::string_view bytes) {
  constexpr std::size_t kTested = std::size_t(1) << 16;
  const std::string head = lowercase(bytes.substr(0, kTested));
  return head.find('\0') == std::string::npos &&
         (head.find("facet") != std::string::npos || head.find("endsolid") != std::string::npos);
}

float from_5_bits(unsigned bits) { return float(bits & 31u) / 31.0f; }

/// Sets the colours of a binary file's facets, if it has any.
void set_colors(std::string_view bytes, std::size_t count, Mesh& mesh) {
  constexpr std::string_view kColor = "COLOR=";
  const std::size_t found = bytes.substr(0, kHeaderLength).find(kColor);
  const bool is_magics = found != std::string_view::npos && found + kColor.size() + 4 <= kHeaderLength;
  glm::vec3 own(0.8f);  // the colour of facets without one
  if (is_magics)
    for (int c = 0; c < 3; ++c) own[c] = float(std::uint8_t(bytes[found + kColor.size() + std::size_t(c)])) / 255.0f;
  own = is_magics ? linear_color(own) : own;
  const auto attribute = [&](std::size_t i) {
    return number_at<std::uint16_t>(bytes.data() + kStart + i * kRow + kAttributeInRow);
  };
  constexpr unsigned kBit15 = 0x8000u;
  bool any = false;
  for (std::size_t i = 0; i < count && !any; ++i) any = is_magics ? attribute(i) != 0 : (attribute(i) & kBit15) != 0;
  if (!any && !is_magics) return;
  mesh.colors.reserve(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const unsigned bits = attribute(i);
    const bool has_color = any && ((bits & kBit15) != 0) != is_magics;
    glm::vec3 color(from_5_bits(bits >> 10), from_5_bits(bits >> 5), from_5_bits(bits));
    if (is_magics) std::swap(color.x, color.z);
    mesh.colors.insert(mesh.colors.end(), 3, has_color ? linear_color(color) : own);
  }
}

/// Replaces coordinates that are rounding errors, such as the sine of pi, by 0, so that vertices at a pole are equal.
void round_to_zero(std::vector<glm::dvec3>& positions) {
  for (int axis = 0; axis < 3; ++axis) {
    double largest = 0.0;
    for (const glm::dvec3& p : positions)
      if (std::isfinite(p[axis])) largest = std::max(largest, std::abs(p[axis]));
    const double error = largest * std::numeric_limits<float>::epsilon();
    for (glm::dvec3& p : positions)
      if (std::abs(p[axis]) < error) p[axis] = 0.0;
  }
}

/// Counts triangles without an area, or with coordinates that are not finite.
std::size_t count_flat(const std::vector<glm::dvec3>& positions) {
  std::size_t count = 0;
  for (std::size_t i = 0; i + 2 < positions.size(); i += 3) {
    const glm::dvec3 normal = glm::cross(positions[i + 1] - positions[i], positions[i + 2] - positions[i]);
    const double area = glm::dot(normal, normal);
    count += !(area > 0.0) || !std::isfinite(area);
  }
  return count;
}

Result<Scene> read_binary(std::string_view bytes, const fs::path& path, Poll* poll) {
  const std::string file = path.string();
  if (bytes.size() < kStart)
    return file_error("'{}' cannot be read as STL (it is neither a text nor a binary STL file)", file);
  Scene scene;
  std::size_t count = number_at<std::uint32_t>(bytes.data() + kHeaderLength);
  const std::size_t rows = (bytes.size() - kStart) / kRow, rest = (bytes.size() - kStart) % kRow;
  // Programs that write a file in one go cannot know the count before the end.
  if ((count == 0 || count == std::numeric_limits<std::uint32_t>::max()) && rows > 0 && rest == 0) {
    count = rows;
    scene.warnings.push_back(fmt::format("the header does not count the triangles; all {} are drawn", rows));
  }
  if (count > rows)
    return file_error("'{}' is cut short, or not an STL file: it counts {} triangles and has bytes for {}", file, count,
                      rows);
  Mesh mesh;
  mesh.name = path.stem().string();
  std::vector<glm::dvec3> positions;
  positions.reserve(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    if (stops(poll, i, count)) return interrupted();
    const char* const row = bytes.data() + kStart + i * kRow + kVerticesInRow;
    for (std::size_t k = 0; k < 3; ++k) {
      const char* const at = row + k * 3 * sizeof(float);
      positions.emplace_back(number_at<float>(at), number_at<float>(at + 4), number_at<float>(at + 8));
    }
  }
  if (const std::size_t trailing = bytes.size() - kStart - count * kRow; trailing > 0) {
    // A file whose bytes were changed on the way, as text, has another length, too.
    if (2 * count_flat(positions) > count)
      return file_error("'{}' is damaged: its length is not that of {} triangles, and most of these are degenerate",
                        file, count);
    scene.warnings.push_back(
        fmt::format("{} bytes after the last triangle are not read{}", trailing,
                    rest == 0 ? fmt::format("; the header counts {} of {} triangles", count, rows) : ""));
  }
  round_to_zero(positions);
  set_positions(positions, mesh, scene);
  set_colors(bytes, count, mesh);
  scene.materials.emplace_back();
  if (!mesh.colors.empty()) scene.materials[0].albedo = glm::vec3(1.0f);
  if (count > 0) scene.meshes.push_back(std::move(mesh));
  return scene;
}

/// The words of a text file.
struct Words {
  const char* at;
  const char* end;

  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
  /// Returns the next word; "#", ";" or "//" begins a comment that extends to the end of the line.
  std::string_view next() {
    while (true) {
      while (at < end && is_blank(*at)) ++at;
      if (at == end || (*at != '#' && *at != ';' && (*at != '/' || at + 1 == end || at[1] != '/'))) break;
      while (at < end && *at != '\n' && *at != '\r') ++at;
    }
    const char* const begin = at;
    while (at < end && !is_blank(*at)) ++at;
    return {begin, std::size_t(at - begin)};
  }
  /// Returns the name after "solid" or "endsolid": the rest of the line, without blanks around it. Some files are a
  /// single line: then the name ends before "facet normal" or "endsolid", and that after "endsolid" before "solid".
  std::string_view name(bool after_end) {
    const char *begin = nullptr, *stop = nullptr;
    while (true) {
      while (at < end && (*at == ' ' || *at == '\t')) ++at;
      if (at == end || is_blank(*at)) break;
      const char* const before = at;
      const std::string_view word = next();
      Words ahead = *this;
      const bool ends =
          after_end ? same_word(word, "solid")
                    : same_word(word, "endsolid") || (same_word(word, "facet") && same_word(ahead.next(), "normal"));
      if (ends) {
        at = before;
        break;
      }
      if (!begin) begin = before;
      stop = at;
    }
    return {begin, std::size_t(stop - begin)};
  }
  bool number(double& value) {
    const std::optional<double> found = number_of(next());
    value = found.value_or(0.0);
    return found.has_value();
  }
};

/// The facets of a text file.
struct Facets {
  std::vector<glm::dvec3> positions;
  struct Solid {
    std::string name;
    std::size_t first;
  };
  std::vector<Solid> solids{{"", 0}};
  std::size_t corners = 0;  ///< of the facet that is being read
  std::size_t bad = 0;
  const char *first_bad = nullptr, *comma = nullptr;  ///< comma: end of the first number with a decimal comma
  bool in_facet = false;

  void mark_bad(const char* at) {
    if (bad++ == 0) first_bad = at;
  }
  /// Ends a facet: one that has not three corners is dropped.
  void end_facet(const char* at) {
    if (in_facet && corners != 3) {
      positions.resize(positions.size() - corners);
      mark_bad(at);
    }
    corners = 0;
    in_facet = false;
  }
};

/// Reads all words; returns false if interrupted.
bool read_facets(Words words, Facets& facets, Poll* poll) {
  const char* const begin = words.at;
  std::size_t count = 0;
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (same_word(word, "vertex")) {
      glm::dvec3 p(0.0);
      const char* const at = word.data();
      bool valid = true;
      // A word that is not a number may be a keyword: it is read again.
      for (int axis = 0; axis < 3 && valid; ++axis) {
        const char* const before = words.at;
        valid = words.number(p[axis]);
        if (valid) continue;
        if (!facets.comma && has_decimal_commas({before, std::size_t(words.at - before)})) facets.comma = words.at;
        words.at = before;
      }
      if (facets.in_facet && valid) {
        facets.positions.push_back(p);
        ++facets.corners;
      } else if (!facets.in_facet) {
        facets.mark_bad(at);
      }
    } else if (same_word(word, "facet")) {
      facets.end_facet(word.data());
      facets.in_facet = true;
      if (poll && ++count % 4096 == 0 && poll->passing(double(word.data() - begin) / double(words.end - begin)))
        return false;
    } else if (same_word(word, "endfacet")) {
      facets.end_facet(word.data());
    } else if (same_word(word, "solid")) {
      facets.end_facet(word.data());
      facets.solids.push_back({std::string(words.name(false)), facets.positions.size()});
    } else if (same_word(word, "endsolid")) {
      facets.end_facet(word.data());
      words.name(true);
    }
  }
  return true;
}

Result<Scene> read_text(std::string_view text, const fs::path& path, Poll* poll) {
  const std::string file = path.string();
  Facets facets;
  const std::string_view facets_text = without_mark(text);
  if (!read_facets({facets_text.data(), facets_text.data() + facets_text.size()}, facets, poll)) return interrupted();
  if (facets.comma) return decimal_commas_error(file, line_number_at(text, facets.comma));
  if (facets.in_facet)
    return file_error("'{}' is cut short: its last facet, after {} others, does not end", file,
                      (facets.positions.size() - facets.corners) / 3);
  const std::size_t count = facets.positions.size() / 3;
  if (facets.bad > 0 && facets.bad * 3 > count)  // one in four of all
    return file_error("'{}' has a facet that is not three vertices of three numbers, before line {}", file,
                      line_number_at(text, facets.first_bad));
  Scene scene;
  if (facets.bad > 0)
    scene.warnings.push_back(
        fmt::format("{} of {} facets are not three vertices of three numbers and are left out, first before line {}",
                    facets.bad, facets.bad + count, line_number_at(text, facets.first_bad)));
  Mesh all;
  round_to_zero(facets.positions);
  set_positions(facets.positions, all, scene);
  scene.materials.emplace_back();
  facets.solids.push_back({"", facets.positions.size()});
  for (std::size_t i = 0; i + 1 < facets.solids.size(); ++i) {
    const std::size_t first = facets.solids[i].first, end = facets.solids[i + 1].first;
    if (first == end) continue;
    Mesh mesh;
    mesh.name = facets.solids[i].name.empty() ? path.stem().string() : facets.solids[i].name;
    mesh.object = int(scene.meshes.size());
    mesh.positions.assign(all.positions.begin() + std::ptrdiff_t(first), all.positions.begin() + std::ptrdiff_t(end));
    scene.meshes.push_back(std::move(mesh));
  }
  return scene;
}

}  // namespace

Result<Scene> read_stl(const fs::path& path, Poll* poll) {
  const auto bytes = read_whole_file(path, poll);
  if (!bytes) return bytes.error();
  Result<Scene> scene = is_text(*bytes) ? read_text(*bytes, path, poll) : read_binary(*bytes, path, poll);
  if (!scene) return scene;
  scene->up = {0.0f, 0.0f, 1.0f};
  for (Mesh& mesh : scene->meshes) {
    mesh.indices.resize(mesh.positions.size());
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) mesh.indices[i] = std::uint32_t(i);
  }
  return scene;
}

}  // namespace umbrage
