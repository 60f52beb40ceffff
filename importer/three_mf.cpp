// 3MF, the format of 3D printing, by the 3MF core specification 1.3 and its materials, production and beam lattice
// extensions. Used instead of Assimp, since Assimp 5.2 drops the colours of triangles.
#include "importer/readers.h"

#include <zip.h>

#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <unordered_map>

#include "importer/common/placed_mesh.h"
#include "importer/importer.h"
#include "importer/three_mf_parts.h"
#include "scene/readers/texture_file.h"
#include "scene/readers/vertex_colors.h"
#include "scene/readers/whole_file.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;
using pugi::xml_node;

/// Parses a transform, 12 numbers: a matrix of 4 rows of 3 that multiplies row vectors from the right.
glm::dmat4 transform_of(const xml_node& node) {
  std::string_view text = attribute(node, "transform");
  glm::dmat4 m(1.0);
  for (int i = 0; i < 12; ++i) {
    const std::size_t start = std::min(text.find_first_not_of(" \t\r\n"), text.size());
    text.remove_prefix(start);
    const auto value = number<double>(text);
    if (!value) return glm::dmat4(1.0);
    m[i / 3][i % 3] = *value;
    text.remove_prefix(std::min(text.find_first_of(" \t\r\n"), text.size()));
  }
  return m;
}

/// Parses "#RRGGBB" or "#RRGGBBAA", sRGB. Returns linear colour and alpha.
glm::vec4 color_of(std::string_view text) {
  constexpr glm::vec4 kNeutral(0.8f, 0.8f, 0.8f, 1.0f);
  constexpr std::size_t kWithAlpha = 9, kPlain = 7;
  if ((text.size() != kPlain && text.size() != kWithAlpha) || text[0] != '#') return kNeutral;
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data() + 1, text.data() + text.size(), value, 16);
  if (error != std::errc() || end != text.data() + text.size()) return kNeutral;
  if (text.size() == kPlain) value = value << 8 | 255;
  const auto byte = [&](int shift) { return float(value >> shift & 255) / 255.0f; };
  return {linear_color({byte(24), byte(16), byte(8)}), byte(0)};
}

/// A group of properties that triangles refer to.
struct Group {
  enum Kind { kMaterials, kColors, kTexture } kind = kMaterials;
  std::vector<int> materials;      ///< kMaterials: indices into Scene::materials; kTexture: one
  std::vector<glm::vec4> colors;   ///< kColors
  std::vector<glm::vec2> corners;  ///< kTexture: texture coordinates
};

/// One .model file of the archive.
struct Part {
  pugi::xml_document document;
  std::map<std::string, xml_node, std::less<>> objects;
  std::map<std::string, Group, std::less<>> groups;
};

/// The reading of one archive.
class Reader {
 public:
  explicit Reader(const fs::path& file) : file_(file.string()) {}
  ~Reader() {
    if (archive_) zip_discard(archive_);
  }
  Reader(const Reader&) = delete;

  Result<Scene> read();

 private:
  Error unreadable(const std::string& reason) const {
    return file_error("'{}' cannot be read as 3MF ({})", file_, reason);
  }
  void warn(const std::string& text) {
    if (warned_.insert(text).second) scene_.warnings.push_back(text);
  }
  Result<std::string> content(std::string name) const;
  Result<Part*> part(const std::string& name);
  void read_group(const xml_node& node, const std::map<std::string, xml_node, std::less<>>& images, Part& to);
  int add_texture(std::string_view path);
  void read_project();
  void warn_of_extensions(const xml_node& model);
  /// `root`: the id of the object that the build names.
  Result<void> add_object(const std::string& part_name, std::string_view id, std::string_view root,
                          const glm::dmat4& place, int depth);
  Result<void> add_build(const std::string& root_part);
  void add_mesh(const xml_node& object, std::string_view root, const Part& of, const glm::dmat4& place);
  void add_beams(const xml_node& object, std::string_view root, const Part& of, const std::vector<glm::dvec3>& vertices,
                 const glm::dmat4& place);
  /// Returns the material of triangles without one, or of those that have colours.
  int plain_material(bool colored);
  /// Returns the material of triangles of a group; those without one have the colour of a filament.
  int material_of(const Group* group, std::uint32_t value, std::string_view filament);
  bool is_hidden(std::string_view kind) {
    if (!kind.empty()) hidden_.emplace(kind);
    return !kind.empty() && !shows_hidden_;
  }

  std::string file_, bytes_;  // bytes_: the archive
  zip_t* archive_ = nullptr;
  std::map<std::string, std::unique_ptr<Part>> parts_;
  Scene scene_;
  std::vector<PlacedMesh> meshes_;
  SlicerProject project_;
  std::map<std::string, int, std::less<>> filaments_;  // materials by colour
  bool shows_hidden_ = false, has_slices_ = false;
  std::set<std::string> warned_, hidden_;
  std::size_t wrong_triangles_ = 0;
  int plain_materials_[2] = {-1, -1}, object_ = 0, placed_count_ = 0;
};

Result<std::string> Reader::content(std::string name) const {
  if (name.starts_with('/')) name.erase(0, 1);
  zip_stat_t status;
  zip_stat_init(&status);
  if (zip_stat(archive_, name.c_str(), ZIP_FL_NOCASE, &status) != 0 || !(status.valid & ZIP_STAT_SIZE))
    return unreadable(fmt::format("its part '{}' is missing", name));
  constexpr std::uint64_t kMaxUnchecked = std::uint64_t(64) << 20, kMaxRatio = 100;  // as for .gz files
  if (status.size > kMaxUnchecked && status.size / kMaxRatio > status.comp_size)
    return unreadable(
        fmt::format("its part '{}' would be inflated from {} to {} bytes", name, status.comp_size, status.size));
  raise_limits_by(double(status.size));
  std::string bytes(status.size, '\0');
  zip_file_t* stream = zip_fopen_index(archive_, status.index, 0);
  if (!stream) return unreadable(zip_strerror(archive_));
  char none = 0;  // libzip compares the checksum when it is asked for more
  const bool is_whole =
      zip_fread(stream, bytes.data(), bytes.size()) == zip_int64_t(bytes.size()) && zip_fread(stream, &none, 1) == 0;
  zip_fclose(stream);
  if (!is_whole) return unreadable(fmt::format("its part '{}' is damaged", name));
  return bytes;
}

int Reader::plain_material(bool colored) {
  int& known = plain_materials_[colored];
  if (known < 0) {
    known = int(scene_.materials.size());
    Material& material = scene_.materials.emplace_back();
    if (colored) material.albedo = glm::vec3(1.0f);  // colours multiply it
  }
  return known;
}

int Reader::material_of(const Group* group, std::uint32_t value, std::string_view filament) {
  if (group && group->kind == Group::kMaterials && value < group->materials.size()) return group->materials[value];
  if (group && group->kind == Group::kTexture) return group->materials[0];
  if (group || filament.empty()) return plain_material(group && group->kind == Group::kColors);
  const auto [entry, is_new] = filaments_.emplace(filament, int(scene_.materials.size()));
  if (is_new) scene_.materials.push_back({.name = std::string(filament), .albedo = glm::vec3(color_of(filament))});
  return entry->second;
}

int Reader::add_texture(std::string_view path) {
  const auto bytes = content(std::string(path));
  auto texture =
      bytes ? decode_texture({reinterpret_cast<const std::uint8_t*>(bytes->data()), bytes->size()}, std::string(path))
            : Result<Texture>(bytes.error());
  if (!texture) {
    warn(texture.error().message + "; its surfaces are shown in a neutral colour");
    return kNoTexture;
  }
  scene_.textures.push_back(std::move(*texture));
  return int(scene_.textures.size()) - 1;
}

void Reader::read_group(const xml_node& node, const std::map<std::string, xml_node, std::less<>>& images, Part& to) {
  const std::string_view kind = local_name(node.name());
  Group group;
  if (kind == "basematerials") {
    for (const xml_node& base : node.children()) {
      const glm::vec4 color = color_of(attribute(base, "displaycolor"));
      Material material{.name = std::string(attribute(base, "name")), .albedo = glm::vec3(color)};
      material.blended = color.a < 1.0f;
      material.opacity = color.a;
      group.materials.push_back(int(scene_.materials.size()));
      scene_.materials.push_back(std::move(material));
    }
  } else if (kind == "colorgroup") {
    group.kind = Group::kColors;
    for (const xml_node& color : node.children()) group.colors.push_back(color_of(attribute(color, "color")));
  } else if (kind == "texture2dgroup") {
    group.kind = Group::kTexture;
    const auto image = images.find(attribute(node, "texid"));
    Material material;
    if (image != images.end()) material.texture = add_texture(attribute(image->second, "path"));
    if (material.texture != kNoTexture) material.albedo = glm::vec3(1.0f);
    group.materials.push_back(int(scene_.materials.size()));
    scene_.materials.push_back(std::move(material));
    for (const xml_node& corner : node.children())
      group.corners.emplace_back(number<float>(attribute(corner, "u")).value_or(0.0f),
                                 number<float>(attribute(corner, "v")).value_or(0.0f));
  } else {
    has_slices_ = has_slices_ || kind == "slicestack";
    if (kind == "compositematerials" || kind == "multiproperties")
      warn(fmt::format("the file's {} are not drawn", kind));
    return;
  }
  to.groups.emplace(attribute(node, "id"), std::move(group));
}

Result<Part*> Reader::part(const std::string& name) {
  if (const auto known = parts_.find(name); known != parts_.end()) return known->second.get();
  const auto bytes = content(name);
  if (!bytes) return bytes.error();
  auto made = std::make_unique<Part>();
  constexpr double kMemoryPerByte = 2.0;
  raise_limits_by(kMemoryPerByte * double(bytes->size()));
  const pugi::xml_parse_result parsed = made->document.load_buffer(bytes->data(), bytes->size());
  if (!parsed)
    return unreadable(fmt::format("its part '{}' is invalid XML at byte {}", name, std::size_t(parsed.offset)));
  warn_of_extensions(child(made->document, "model"));
  const xml_node resources = child(child(made->document, "model"), "resources");
  std::map<std::string, xml_node, std::less<>> images;
  for (const xml_node& node : resources.children()) {
    if (local_name(node.name()) == "texture2d") images.emplace(attribute(node, "id"), node);
    if (local_name(node.name()) == "object") made->objects.emplace(attribute(node, "id"), node);
  }
  for (const xml_node& node : resources.children())
    if (local_name(node.name()) != "object") read_group(node, images, *made);
  return (parts_[name] = std::move(made)).get();
}

void Reader::warn_of_extensions(const xml_node& model) {
  constexpr std::string_view kKnown[] = {"/material/", "/production/", "/beamlattice/", "/slice/", "/trianglesets/"};
  std::string_view prefixes = attribute(model, "requiredextensions");
  while (!prefixes.empty()) {
    const std::string prefix(prefixes.substr(0, prefixes.find(' ')));
    prefixes.remove_prefix(std::min(prefix.size() + 1, prefixes.size()));
    std::string name = model.attribute(("xmlns:" + prefix).c_str()).value();
    if (name.empty()) name = prefix;
    const auto is_in_name = [&](std::string_view known) { return name.find(known) != std::string::npos; };
    if (!name.empty() && std::none_of(std::begin(kKnown), std::end(kKnown), is_in_name))
      warn(fmt::format("the file requires the extension '{}', which is not read; what it adds is not drawn", name));
  }
}

/// Adds the beams of a mesh, in the colour of its object.
void Reader::add_beams(const xml_node& object, std::string_view root, const Part& of,
                       const std::vector<glm::dvec3>& vertices, const glm::dmat4& place) {
  const xml_node lattice = child(child(object, "mesh"), "beamlattice");
  if (!lattice) return;
  if (!attribute(lattice, "clippingmesh").empty()) warn("the file's beams are not clipped by a mesh");
  const auto found = of.groups.find(attribute(object, "pid"));
  const Group* const group = found == of.groups.end() ? nullptr : &found->second;
  const auto value = number<std::uint32_t>(attribute(object, "pindex")).value_or(0);
  const int material = material_of(group, value, project_.color(root, project_.find(root, attribute(object, "id"), 0)));
  const double scale = std::cbrt(std::abs(glm::determinant(glm::dmat3(place))));
  for (PlacedMesh& made : beams_of(lattice, vertices, scale)) {
    if (group && value < group->colors.size())
      made.mesh.colors.assign(made.positions.size(), glm::vec3(group->colors[value]));
    made.mesh.name = attribute(object, "name");
    made.mesh.material = material;
    made.mesh.object = object_;
    meshes_.push_back(std::move(made));
  }
}

void Reader::add_mesh(const xml_node& object, std::string_view root, const Part& of, const glm::dmat4& place) {
  const xml_node mesh = child(object, "mesh");
  std::vector<glm::dvec3> vertices;
  for (const xml_node& vertex : child(mesh, "vertices").children()) {
    const auto at = [&](const char* name) {
      return number<double>(vertex.attribute(name).value()).value_or(std::numeric_limits<double>::quiet_NaN());
    };
    vertices.emplace_back(place * glm::dvec4(at("x"), at("y"), at("z"), 1.0));
  }
  const bool mirrored = glm::determinant(glm::dmat3(place)) < 0.0;
  const std::string_view object_group = attribute(object, "pid");
  const auto object_index = number<std::uint32_t>(attribute(object, "pindex")).value_or(0);
  // By material, with the indices of their vertices.
  std::map<int, std::pair<PlacedMesh, std::unordered_map<std::uint64_t, std::uint32_t>>> meshes;
  const std::string_view id = attribute(object, "id");
  std::uint32_t number_of_triangle = 0;
  for (const xml_node& triangle : child(mesh, "triangles").children()) {
    const SlicerPart* const part = project_.find(root, id, number_of_triangle++);
    if (part && is_hidden(part->hidden_as)) continue;
    const char* const names[] = {"v1", "v2", "v3"};
    const char* const properties[] = {"p1", "p2", "p3"};
    std::uint32_t corners[3], values[3];
    bool sound = true;
    const std::string_view own_group = triangle.attribute("pid").value();
    for (int k = 0; k < 3; ++k) {
      const auto corner = number<std::uint32_t>(triangle.attribute(names[k]).value());
      sound = sound && corner && *corner < vertices.size();
      corners[k] = corner.value_or(0);
      const auto first = number<std::uint32_t>(triangle.attribute("p1").value());
      values[k] =
          number<std::uint32_t>(triangle.attribute(properties[k]).value()).value_or(first.value_or(object_index));
    }
    if (!sound) {
      ++wrong_triangles_;
      continue;
    }
    if (triangle.attribute("paint_color") || triangle.attribute("slic3rpe:mmu_segmentation"))
      warn("colours painted in a slicer are not drawn");
    const auto found = of.groups.find(own_group.empty() ? object_group : own_group);
    const Group* group = found == of.groups.end() ? nullptr : &found->second;
    const bool colored = group && group->kind == Group::kColors, textured = group && group->kind == Group::kTexture;
    const int material = material_of(group, values[0], project_.color(root, part));
    auto& [to, index_of] = meshes[material];
    to.mesh.material = material;
    if (mirrored) std::swap(corners[1], corners[2]), std::swap(values[1], values[2]);
    for (int k = 0; k < 3; ++k) {
      const std::uint64_t key = corners[k] | (colored || textured ? std::uint64_t(values[k]) << 32 : 0);
      const auto [entry, is_new] = index_of.emplace(key, std::uint32_t(to.positions.size()));
      to.mesh.indices.push_back(entry->second);
      if (!is_new) continue;
      to.positions.push_back(vertices[corners[k]]);
      if (colored)
        to.mesh.colors.push_back(values[k] < group->colors.size() ? glm::vec3(group->colors[values[k]])
                                                                  : glm::vec3(0.8f));
      if (textured)
        to.mesh.uvs.push_back(values[k] < group->corners.size() ? group->corners[values[k]] : glm::vec2(0.0f));
    }
  }
  for (auto& [material, made] : meshes) {
    made.first.mesh.name = attribute(object, "name");
    made.first.mesh.object = object_;
    meshes_.push_back(std::move(made.first));
  }
  add_beams(object, root, of, vertices, place);
  if (!meshes_.empty() && meshes_.back().mesh.object == object_) ++object_;
}

Result<void> Reader::add_object(const std::string& part_name, std::string_view id, std::string_view root,
                                const glm::dmat4& place, int depth) {
  constexpr int kMaxDepth = 64, kMaxPlaced = 100'000;
  if (depth > kMaxDepth) return unreadable("its objects contain each other");
  if (++placed_count_ > kMaxPlaced)
    return unreadable(fmt::format("its objects are placed more than {} times", kMaxPlaced));
  const auto of = part(part_name);
  if (!of) return of.error();
  const auto object = (*of)->objects.find(id);
  if (object == (*of)->objects.end()) return unreadable(fmt::format("its part '{}' has no object '{}'", part_name, id));
  if (is_hidden(hidden_kind(object->second))) return {};
  add_mesh(object->second, root, **of, place);
  for (const xml_node& component : child(object->second, "components").children()) {
    const std::string path(attribute(component, "path"));
    auto added = add_object(path.empty() ? part_name : path, attribute(component, "objectid"), root,
                            place * transform_of(component), depth + 1);
    if (!added) return added;
  }
  return {};
}

/// Returns the length of a unit of the specification, mm.
double unit_of(std::string_view name) {
  constexpr std::pair<std::string_view, double> kUnits[] = {
      {"micron", 0.001}, {"centimeter", 10.0}, {"inch", 25.4}, {"foot", 304.8}, {"meter", 1000.0}};
  for (const auto& [known, length] : kUnits)
    if (known == name) return length;
  return 1.0;  // millimetre, also the default
}

Result<void> Reader::add_build(const std::string& root) {
  const auto first = part(root);
  if (!first) return first.error();
  const xml_node model = child((*first)->document, "model");
  scene_.up = {0.0f, 0.0f, 1.0f};
  const double unit = unit_of(attribute(model, "unit"));
  glm::dmat4 to_millimetres(unit);
  to_millimetres[3][3] = 1.0;
  for (const xml_node& item : child(model, "build").children()) {
    const std::string path(attribute(item, "path"));
    const std::string_view id = attribute(item, "objectid");
    auto added = add_object(path.empty() ? root : path, id, id, to_millimetres * transform_of(item), 0);
    if (!added) return added;
  }
  if (child(model, "build").first_child()) return {};
  warn("the file's build is empty; all objects are drawn");
  std::set<std::string_view> components;
  for (const auto& [id, object] : (*first)->objects)
    for (const xml_node& each : child(object, "components").children()) components.insert(attribute(each, "objectid"));
  for (const auto& [id, object] : (*first)->objects)
    if (!components.contains(id))
      if (auto added = add_object(root, id, id, to_millimetres, 0); !added) return added;
  return {};
}

/// Reads what slicers add.
void Reader::read_project() {
  for (const char* name : {"Metadata/Slic3r_PE_model.config", "Metadata/model_settings.config"})
    if (const auto config = content(name)) {
      pugi::xml_document document;
      document.load_buffer(config->data(), config->size());
      project_.add_objects(document.child("config"));
    }
  for (const char* name : {"Metadata/Slic3r_PE.config", "Metadata/project_settings.config"})
    if (const auto settings = content(name)) project_.add_colors(*settings);
}

Result<Scene> Reader::read() {
  auto bytes = read_whole_file(file_);
  if (!bytes) return bytes.error();
  bytes_ = std::move(*bytes);
  zip_source_t* const source = zip_source_buffer_create(bytes_.data(), bytes_.size(), 0, nullptr);
  if (!source) throw std::bad_alloc();
  archive_ = zip_open_from_source(source, ZIP_RDONLY, nullptr);
  if (!archive_) zip_source_free(source);
  if (!archive_) return unreadable("it is not a zip archive, or cut short");
  std::string root = "3D/3dmodel.model";
  if (const auto relations = content("_rels/.rels")) {
    pugi::xml_document document;
    document.load_buffer(relations->data(), relations->size());
    for (const xml_node& relation : child(document, "Relationships").children())
      if (attribute(relation, "Type").ends_with("/3dmodel")) root = attribute(relation, "Target");
  }
  read_project();
  auto added = add_build(root);
  if (added && meshes_.empty() && !hidden_.empty()) {
    shows_hidden_ = true;
    placed_count_ = 0;
    added = add_build(root);
  }
  if (!added) return added.error();
  if (has_slices_ && meshes_.empty()) return unreadable("it has only slices, which are not read");
  if (has_slices_) warn("the file's slices are not drawn");
  if (!hidden_.empty())
    warn(shows_hidden_ ? fmt::format("the file has only {}; they are drawn", fmt::join(hidden_, " and "))
                       : fmt::format("the file's {} are left out", fmt::join(hidden_, ", ")));
  if (wrong_triangles_ > 0)
    warn(fmt::format("{} triangles have vertex indices out of range and are left out", wrong_triangles_));
  move_to_scene(std::move(meshes_), scene_);
  return std::move(scene_);
}

}  // namespace

Result<Scene> read_3mf(const fs::path& file) { return Reader(file).read(); }

}  // namespace umbrage
