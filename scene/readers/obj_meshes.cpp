#include "scene/readers/obj_meshes.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <limits>
#include <set>

#include "core/lowercase.h"
#include "scene/readers/polygon.h"
#include "scene/readers/positions.h"
#include "scene/readers/text_rules.h"
#include "scene/readers/vertex_colors.h"

namespace umbrage {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// Returns the smoothing group of a statement s: "off", "0", "on" or a number.
std::uint32_t smoothing_of(std::string_view name) {
  if (name == "on") return 1;
  std::uint32_t group = 0;
  std::from_chars(name.data(), name.data() + name.size(), group);
  return group;
}

/// Returns "'a', 'b' and 3 more".
std::string list_of(const std::vector<std::string>& names) {
  constexpr std::size_t kMaxShown = 4;
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), kMaxShown); ++i)
    list += (i == 0 ? "'" : i + 1 == names.size() ? " and '" : ", '") + names[i] + "'";
  return names.size() > kMaxShown ? fmt::format("{} and {} more", list, names.size() - kMaxShown) : list;
}

}  // namespace

ObjMeshes::ObjMeshes(const ObjFile& file, std::vector<ObjBlock> blocks, Poll* poll)
    : file_(file), blocks_(std::move(blocks)), poll_(poll) {}

Result<ObjScene> ObjMeshes::scene() {
  const std::string name = file_.path.string();
  result_.scene.warnings = file_.warnings;
  std::size_t vertex_lines = 0;
  for (const ObjBlock& block : blocks_) {
    face_count_ += block.faces.size();
    vertex_lines += block.vertex_lines;
    bad_positions_.add(block.bad_positions);
    commas_.add(block.commas);
    last_positions_ = block.faces.empty() ? last_positions_ + block.positions.size()
                                          : block.positions.size() - block.positions_of_faces;
    lines_.add(block.lines);
    points_.add(block.points);
    curves_.add(block.curves);
  }
  constexpr std::size_t kMaxBad = 4;  // one in four
  if (commas_.count * kMaxBad > vertex_lines) return decimal_commas_error(name, line_number(file_.text, commas_.first));
  if (commas_.count > 0 && bad_positions_.count == 0)
    result_.scene.warnings.push_back(fmt::format("numbers with decimal commas are not read, the first in line {}",
                                                 line_number(file_.text, commas_.first)));
  if (face_count_ == 0 && vertex_lines == 0 && lines_.count == 0)
    return file_error("'{}' cannot be read as OBJ (it has no vertices and no faces)", name);
  if (face_count_ == 0 && lines_.count + curves_.count > 0)
    return file_error("'{}' has no triangles; {} are not drawn", name,
                      lines_.count > 0 ? "lines" : "free-form curves and surfaces");
  check_faces();
  if (ended()) return interrupted();
  convert_vertices();
  if (face_count_ == 0) {
    if (!add_points())
      return file_error("'{}' has no points that can be drawn; none has three finite numbers{}", name, bad_line());
  } else {
    if (bad_count_ == face_count_)
      return file_error(
          "'{}' has no triangles that can be drawn; all {} faces have vertices that are missing or not finite, the "
          "first in line {}{}",
          name, face_count_, first_bad_line_, bad_line());
    sort_faces();
    if (ended()) return interrupted();
    newest_.assign(positions_.size(), kNone);
    for (const Part& part : parts_) {
      add_meshes(part);
      if (ended()) return interrupted();
    }
  }
  warn_of_elements();
  warn_of_materials();
  return std::move(result_);
}

/// Returns a clause that names the first vertex with something other than three finite numbers, if there is any.
std::string ObjMeshes::bad_line() const {
  if (bad_positions_.count == 0) return "";
  return fmt::format(" (line {} is not a vertex of three finite numbers)",
                     line_number(file_.text, bad_positions_.first));
}

/// Sets kinds_, bad_count_ and the origin, and converts the positions.
void ObjMeshes::check_faces() {
  std::size_t position_count = 0, uv_count = 0, normal_count = 0;
  for (const ObjBlock& block : blocks_) {
    position_count += block.positions.size();
    uv_count += block.uvs.size();
    normal_count += block.normals.size();
  }
  std::vector<glm::dvec3> positions;
  positions.reserve(position_count);
  for (ObjBlock& block : blocks_) {
    positions.insert(positions.end(), block.positions.begin(), block.positions.end());
    position_counts_.push_back(block.positions.size());
    std::vector<glm::dvec3>().swap(block.positions);
  }
  OriginFinder finder;
  const auto is_in = [](std::int32_t index, std::size_t count) { return index >= 0 && std::size_t(index) < count; };
  const auto kind_of = [&](const ObjCorner* corner, const ObjCorner* end) {
    std::uint8_t kind = kWithUvs | kWithNormals;
    bool has_lost_uvs = false;
    for (; corner != end; ++corner) {
      if (!is_in(corner->x, position_count) || !is_finite(positions[std::size_t(corner->x)])) return kBad;
      finder.add(positions[std::size_t(corner->x)]);
      if (!is_in(corner->y, uv_count)) kind &= std::uint8_t(~kWithUvs);
      if (!is_in(corner->z, normal_count)) kind &= std::uint8_t(~kWithNormals);
      has_lost_uvs = has_lost_uvs || (corner->y != kNoObjIndex && !is_in(corner->y, uv_count));
    }
    lost_uvs_ += has_lost_uvs;
    return FaceKind(kind);
  };
  for (const ObjBlock& block : blocks_) {
    if (poll_ && poll_->passing(0.0)) return;
    std::vector<std::uint8_t>& kinds = kinds_.emplace_back(block.faces.size());
    std::uint32_t first = 0;
    for (std::size_t f = 0; f < block.faces.size(); ++f) {
      const ObjFace& face = block.faces[f];
      const ObjCorner* corners = block.corners.data();
      const bool is_bad = face.is_bad || face.end < first + 3;
      kinds[f] = is_bad ? kBad : kind_of(corners + first, corners + face.end);
      first = face.end;
      if (kinds[f] == kBad && bad_count_++ == 0) first_bad_line_ = line_of(block, face);
    }
  }
  if (face_count_ == 0)
    for (const glm::dvec3& p : positions) finder.add(p);
  const glm::dvec3 origin = finder.origin();
  result_.scene.origin = origin;
  positions_.reserve(position_count);
  for (const glm::dvec3& p : positions) positions_.emplace_back(p - origin);
}

/// Joins the other vertex data of all blocks.
void ObjMeshes::convert_vertices() {
  const bool colored =
      std::any_of(blocks_.begin(), blocks_.end(), [](const ObjBlock& block) { return !block.colors.empty(); });
  for (ObjBlock& block : blocks_) {
    std::copy(block.normals.begin(), block.normals.end(), std::back_inserter(normals_));
    for (const glm::dvec2& uv : block.uvs) uvs_.emplace_back(uv);
    std::vector<glm::dvec2>().swap(block.uvs);
    std::vector<glm::vec3>().swap(block.normals);
  }
  if (!colored) return;
  std::size_t end = 0;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    std::copy(blocks_[b].colors.begin(), blocks_[b].colors.end(), std::back_inserter(colors_));
    colors_.resize(end += position_counts_[b], glm::vec3(1.0f));
  }
  // Colours are 0 to 1, or 0 to 255 if any value is above 1.
  const bool bytes = std::any_of(colors_.begin(), colors_.end(), [](const glm::vec3& c) {
    return std::max({c.x, c.y, c.z}) > 1.0f;
  });
  for (glm::vec3& color : colors_) color = linear_color(bytes ? color / 255.0f : color);
}

/// Returns the number of a name, in the order in which names appear.
int ObjMeshes::Names::number_of(std::string_view name) {
  const auto [known, is_new] = numbers.emplace(name, int(all.size()));
  if (is_new) all.push_back(name);
  return known->second;
}

/// Distributes the faces to parts_.
void ObjMeshes::sort_faces() {
  int object = names_.number_of(""), group = object, material = object;
  const int no_name = object;
  std::uint32_t smoothing = 0;
  std::size_t part = 0;
  bool changed = true;
  for (const MtlMaterial& each : file_.materials) defined_.emplace(names_.number_of(each.name), &each);
  for (std::uint32_t b = 0; b < blocks_.size(); ++b) {
    if (poll_ && poll_->passing(0.0)) return;
    const ObjBlock& block = blocks_[b];
    std::size_t first = 0;
    const auto add_run = [&](std::size_t last) {
      if (last == first) return;
      if (changed) part = part_of({object, group}, material);
      changed = false;
      parts_[part].runs.push_back({b, first, last, smoothing});
      first = last;
    };
    for (const ObjStatement& statement : block.statements) {
      add_run(statement.face);
      if (statement.kind == ObjStatement::kSmoothing) {
        has_smoothing_ = true;
        smoothing = smoothing_of(statement.name);
        continue;
      }
      changed = true;
      const int name = names_.number_of(statement.name);
      if (statement.kind == ObjStatement::kMaterial) material = name;
      if (statement.kind == ObjStatement::kGroup) group = name;
      if (statement.kind == ObjStatement::kObject) object = name, group = no_name;
    }
    add_run(block.faces.size());
  }
}

/// Returns the index of the part of an object, given by the numbers of its name and group, and a material.
std::size_t ObjMeshes::part_of(std::pair<int, int> object, int material_name) {
  const int object_number = object_numbers_.emplace(object, int(object_numbers_.size())).first->second;
  const int material = material_named(material_name);
  const auto [known, is_new] = part_numbers_.emplace(std::pair(object_number, material), parts_.size());
  if (is_new) {
    const std::string_view group = names_.all[std::size_t(object.second)];
    const std::string_view name = group.empty() ? names_.all[std::size_t(object.first)] : group;
    parts_.push_back({std::string(name), object_number, material, {}});
  }
  return known->second;
}

/// Returns the index of a material of the scene. Materials that no library defines are neutral.
int ObjMeshes::material_named(int number) {
  std::vector<Material>& materials = result_.scene.materials;
  const auto [known, is_new] = material_numbers_.emplace(number, int(materials.size()));
  if (!is_new) return known->second;
  const std::string_view name = names_.all[std::size_t(number)];
  const auto found = defined_.find(number);
  const MtlMaterial* source = found == defined_.end() ? nullptr : found->second;
  Material neutral;
  neutral.name = name;
  materials.push_back(source ? material_of(*source) : neutral);
  result_.sources.push_back(source);
  if (!source && !name.empty()) undefined_.emplace_back(name);
  return known->second;
}

/// Adds the meshes of a part: one for each combination of vertex data.
void ObjMeshes::add_meshes(const Part& part) {
  bool exists[4] = {};
  for (const Run& run : part.runs)
    for (std::size_t f = run.first; f < run.last; ++f)
      if (kinds_[run.block][f] != kBad) exists[kinds_[run.block][f]] = true;
  for (const FaceKind kind : {kPlain, kWithUvs, kWithNormals, FaceKind(kWithUvs | kWithNormals)})
    if (exists[kind]) result_.scene.meshes.push_back(mesh_of(part, kind));
}

std::uint32_t ObjMeshes::vertex_of(const ObjCorner& corner) {
  constexpr int kMaxCompared = 16;  // bounds the time if thousands of corners share a position; copies do no harm
  std::uint32_t& newest = newest_[std::size_t(corner.x)];
  std::uint32_t at = newest;
  for (int k = 0; k < kMaxCompared && at != kNone; ++k, at = vertices_[at].next)
    if (vertices_[at].corner == corner) return at;
  vertices_.push_back({corner, newest});
  return newest = std::uint32_t(vertices_.size() - 1);
}

Mesh ObjMeshes::mesh_of(const Part& part, FaceKind kind) {
  Mesh mesh{.name = part.name, .material = part.material, .object = part.object};
  const bool has_uvs = kind & kWithUvs, has_normals = kind & kWithNormals, smooths = has_smoothing_ && !has_normals;
  vertices_.clear();
  std::vector<std::uint32_t> face, triangles;
  std::vector<glm::vec3> polygon;
  std::size_t face_count = 0;
  for (const Run& run : part.runs) face_count += run.last - run.first;
  mesh.indices.reserve(3 * face_count);
  for (const Run& run : part.runs) {
    const ObjBlock& block = blocks_[run.block];
    if (poll_ && poll_->passing(0.0)) return mesh;
    for (std::size_t f = run.first; f < run.last; ++f) {
      if (kinds_[run.block][f] != kind) continue;
      face.clear();
      for (std::uint32_t c = f == 0 ? 0 : block.faces[f - 1].end; c < block.faces[f].end; ++c) {
        const ObjCorner& corner = block.corners[c];
        face.push_back(vertex_of({corner.x, has_uvs ? corner.y : kNoObjIndex, has_normals ? corner.z : kNoObjIndex}));
      }
      if (face.size() == 3) {
        mesh.indices.insert(mesh.indices.end(), face.begin(), face.end());
      } else {
        polygon.clear();
        triangles.clear();
        for (const std::uint32_t vertex : face) polygon.push_back(positions_[std::size_t(vertices_[vertex].corner.x)]);
        split_polygon(polygon, triangles, poll_);
        for (const std::uint32_t corner : triangles) mesh.indices.push_back(face[corner]);
      }
      if (smooths) mesh.smoothing.resize(mesh.indices.size() / 3, run.smoothing);
    }
  }
  mesh.positions.reserve(vertices_.size());
  for (const Vertex& vertex : vertices_) mesh.positions.push_back(positions_[std::size_t(vertex.corner.x)]);
  if (has_uvs)
    for (const Vertex& vertex : vertices_) mesh.uvs.push_back(uvs_[std::size_t(vertex.corner.y)]);
  if (has_normals)
    for (const Vertex& vertex : vertices_) mesh.normals.push_back(normals_[std::size_t(vertex.corner.z)]);
  if (!colors_.empty())
    for (const Vertex& vertex : vertices_) mesh.colors.push_back(colors_[std::size_t(vertex.corner.x)]);
  const auto is_white = [](const glm::vec3& color) { return color == glm::vec3(1.0f); };
  if (std::all_of(mesh.colors.begin(), mesh.colors.end(), is_white)) mesh.colors.clear();
  for (const Vertex& vertex : vertices_) newest_[std::size_t(vertex.corner.x)] = kNone;
  return mesh;
}

/// Adds the vertices as points: with colours if every vertex has one, and with normals if there are as many. Returns
/// false if there are none.
bool ObjMeshes::add_points() {
  Mesh mesh{.name = file_.path.stem().string(), .points = true};
  const bool has_normals = normals_.size() == positions_.size(), has_colors = colors_.size() == positions_.size();
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    const glm::vec3& p = positions_[i];
    if (!is_finite(p)) {
      ++bad_count_;
      continue;
    }
    mesh.positions.push_back(p);
    if (has_normals) mesh.normals.push_back(normals_[i]);
    if (has_colors) mesh.colors.push_back(colors_[i]);
  }
  result_.scene.materials.emplace_back().albedo = glm::vec3(has_colors ? 1.0f : 0.8f);
  result_.sources.push_back(nullptr);
  if (bad_count_ > 0)
    result_.scene.warnings.push_back(
        fmt::format("{} of {} points do not have three finite numbers and are left out; the first is in line {}",
                    bad_count_, positions_.size(), line_number(file_.text, bad_positions_.first)));
  if (mesh.positions.empty()) return false;
  result_.scene.meshes.push_back(std::move(mesh));
  return true;
}

/// Adds warnings of faces and other elements that are not drawn.
void ObjMeshes::warn_of_elements() {
  std::vector<std::string>& warnings = result_.scene.warnings;
  if (face_count_ > 0 && bad_count_ > 0)
    warnings.push_back(fmt::format(
        "{} of {} faces have vertices that are missing or not finite and are left out; the first is in line {}{}",
        bad_count_, face_count_, first_bad_line_, bad_line()));
  if (lost_uvs_ > 0)
    warnings.push_back(
        fmt::format("{} of {} faces have indices of texture coordinates out of range and are drawn without texture",
                    lost_uvs_, face_count_));
  const auto warn_of = [&](const ObjLines& what, const char* name) {
    if (what.count > 0)
      warnings.push_back(fmt::format("the file has {}, which are not drawn; the first is in line {}", name,
                                     line_number(file_.text, what.first)));
  };
  warn_of_missing_faces();
  warn_of(lines_, "lines");
  if (face_count_ > 0) warn_of(points_, "points beside faces");
  warn_of(curves_, "free-form curves or surfaces");
  std::vector<std::string> others;
  std::set<std::string_view> known;
  for (const ObjBlock& block : blocks_)
    for (const std::string_view word : block.other)
      if (known.insert(word).second) others.emplace_back(word);
  if (!others.empty())
    warnings.push_back(fmt::format("the file has statements that are not known and are ignored: {}", list_of(others)));
}

/// Adds a warning if the text ends with vertices for which there are no faces, as that of a file that is cut short.
/// Vertices alone may be points, unless the last line has no end, or there are statements of meshes.
void ObjMeshes::warn_of_missing_faces() {
  if (last_positions_ == 0 || lines_.count + points_.count + curves_.count > 0) return;
  const std::size_t first = positions_.size() - last_positions_;
  const auto uses_last = [&](const ObjBlock& block) {
    return std::any_of(block.corners.begin(), block.corners.end(),
                       [&](const ObjCorner& corner) { return corner.x >= 0 && std::size_t(corner.x) >= first; });
  };
  const auto has_statements = [](const ObjBlock& block) { return !block.statements.empty(); };
  const bool is_of_mesh = !uvs_.empty() || !file_.libraries.empty() || !file_.missing_libraries.empty() ||
                          std::any_of(blocks_.begin(), blocks_.end(), has_statements);
  if (face_count_ == 0 && (file_.ends_in_line || is_of_mesh))
    result_.scene.warnings.push_back(
        "the file has vertices and no faces, as if it were cut short; they are drawn as points");
  else if (face_count_ > 0 && std::none_of(blocks_.begin(), blocks_.end(), uses_last))
    result_.scene.warnings.push_back(fmt::format(
        "the last {} vertices belong to no face: faces are missing, as if the file were cut short", last_positions_));
}

/// Adds warnings of materials that are missing or invisible. If all are invisible, they are drawn opaque.
void ObjMeshes::warn_of_materials() {
  Scene& scene = result_.scene;
  const auto is_invisible = [](const Material& each) { return each.blended && each.opacity == 0.0f; };
  const bool all_invisible = std::all_of(scene.materials.begin(), scene.materials.end(), is_invisible);
  std::vector<std::string> invisible, opaque;
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    Material& material = scene.materials[m];
    if (is_invisible(material)) (all_invisible ? opaque : invisible).push_back(material.name);
    if (result_.sources[m] && is_invisible_by_tr(*result_.sources[m])) opaque.push_back(material.name);
    if (all_invisible) material.blended = false, material.opacity = 1.0f;
  }
  const auto noun = [](const std::vector<std::string>& names, const char* one, const char* several) {
    return fmt::format("{} {}", names.size() == 1 ? one : several, list_of(names));
  };
  if (!invisible.empty())
    scene.warnings.push_back(noun(invisible, "the material", "the materials") +
                             (invisible.size() == 1 ? " is" : " are") + " fully transparent and not seen");
  if (!opaque.empty())
    scene.warnings.push_back(noun(opaque, "the material", "the materials") + " would be fully transparent and " +
                             (opaque.size() == 1 ? "is" : "are") + " drawn opaque");
  const auto& missing = file_.missing_libraries;
  if (!missing.empty()) {
    scene.warnings.push_back(fmt::format(
        "{} not exist; surfaces are shown in a neutral colour",
        noun(missing, "the material library", "the material libraries") + (missing.size() == 1 ? " does" : " do")));
  } else if (!undefined_.empty()) {
    const bool one = undefined_.size() == 1;
    std::string reason = file_.libraries.empty()
                             ? "names no material library"
                             : fmt::format("its material library does not define {}", one ? "it" : "them");
    std::set<std::string> lower;
    std::vector<std::string> similar;
    for (const std::string& name : undefined_) lower.insert(lowercase(name));
    for (const MtlMaterial& each : file_.materials)
      if (lower.contains(lowercase(each.name))) similar.push_back(each.name);
    if (!similar.empty()) reason += fmt::format(" (it defines {})", list_of(similar));
    scene.warnings.push_back(fmt::format("the file uses {}, but {}; {} surfaces are shown in a neutral colour",
                                         noun(undefined_, "the material", "the materials"), reason,
                                         one ? "its" : "their"));
  }
}

std::size_t ObjMeshes::line_of(const ObjBlock& block, const ObjFace& face) const {
  return line_number(file_.text, std::size_t(block.text.data() - file_.text.data()) + face.line);
}

}  // namespace umbrage
