// Reads the JSON part of glTF 2.0 files.
#include "importer/gltf_facts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/trigonometric.hpp>
#include <nlohmann/json.hpp>
#include <system_error>

#include "scene/readers/whole_file.h"

namespace umbrage {
namespace {

using Json = nlohmann::json;

/// The start of a .glb file.
struct GlbStart {
  char magic[4];
  std::uint32_t version, length, json_length, json_type;
};

/// Returns the JSON text of a .gltf or .glb file; empty if it cannot be read.
std::string json_text(const std::filesystem::path& file) {
  if (is_gzip_file(file)) {
    const auto bytes = read_whole_file(file);
    if (!bytes || !bytes->starts_with("glTF") || bytes->size() < sizeof(GlbStart)) return bytes ? *bytes : "";
    GlbStart start{};
    std::memcpy(&start, bytes->data(), sizeof start);
    return start.json_length > bytes->size() ? "" : bytes->substr(sizeof start, start.json_length);
  }
  std::ifstream stream(file, std::ios::binary);
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (!stream || error) return "";
  GlbStart start{};
  stream.read(reinterpret_cast<char*>(&start), sizeof start);
  std::uintmax_t length = size;
  if (stream && std::memcmp(start.magic, "glTF", sizeof start.magic) == 0) {
    length = start.json_length;
    if (length > size) return "";
  } else {
    stream.clear();
    stream.seekg(0);
  }
  std::string text(std::size_t(length), '\0');
  if (!stream.read(text.data(), std::streamsize(length))) return "";
  return text;
}

/// Returns a member of an object, or null if it is missing or `object` is no object.
const Json& member(const Json& object, const char* name) {
  static const Json nothing;
  if (!object.is_object()) return nothing;
  const auto found = object.find(name);
  return found == object.end() ? nothing : *found;
}
const Json& element(const Json& list, std::size_t k) {
  static const Json nothing;
  return list.is_array() && k < list.size() ? list[k] : nothing;
}
float number(const Json& value, float fallback) {
  const float v = value.is_number() ? value.get<float>() : fallback;
  return std::isfinite(v) ? v : fallback;
}
/// Returns `value` as an index, or -1 if it is not a valid index.
int index_in(const Json& value) {
  constexpr int kMax = 1 << 28;
  const bool fits = value.is_number_integer() && value.get<std::int64_t>() >= 0 && value.get<std::int64_t>() < kMax;
  return fits ? value.get<int>() : -1;
}
std::string text_of(const Json& value) { return value.is_string() ? value.get<std::string>() : std::string(); }

GltfPlacement placement_of(const Json& use) {
  GltfPlacement placement;
  placement.set = std::max(index_in(member(use, "texCoord")), 0);
  const Json& transform = member(member(use, "extensions"), "KHR_texture_transform");
  if (!transform.is_object()) return placement;
  for (int axis = 0; axis < 2; ++axis) {
    placement.offset[axis] = number(element(member(transform, "offset"), std::size_t(axis)), 0.0f);
    placement.scale[axis] = number(element(member(transform, "scale"), std::size_t(axis)), 1.0f);
  }
  placement.rotation = number(member(transform, "rotation"), 0.0f);
  if (const int set = index_in(member(transform, "texCoord")); set >= 0) placement.set = set;
  return placement;
}

constexpr std::string_view kMaterialExtension = "KHR_materials_";

/// Returns whether an extension of a material changes its look and is not drawn.
bool is_ignored(const std::string& name, const Json& properties) {
  constexpr std::string_view kDrawn[] = {"unlit", "emissive_strength", "pbrSpecularGlossiness"};
  if (!name.starts_with(kMaterialExtension)) return false;
  const std::string_view kind = std::string_view(name).substr(kMaterialExtension.size());
  constexpr float kDefaultIor = 1.5f;
  if (kind == "ior") return number(member(properties, "ior"), kDefaultIor) != kDefaultIor;
  return std::find(std::begin(kDrawn), std::end(kDrawn), kind) == std::end(kDrawn);
}

GltfMaterial material_of(const Json& json) {
  GltfMaterial material;
  const Json& color = member(json, "pbrMetallicRoughness");
  const auto set_map = [&](GltfMap map, const Json& use) {
    if (use.is_object()) material.maps[map] = placement_of(use);
  };
  set_map(kColorMap, member(color, "baseColorTexture"));
  set_map(kEmissionMap, member(json, "emissiveTexture"));
  set_map(kSurfaceMap, member(color, "metallicRoughnessTexture"));
  set_map(kNormalMap, member(json, "normalTexture"));
  set_map(kOcclusionMap, member(json, "occlusionTexture"));
  const auto fraction = [](const Json& value) { return std::clamp(number(value, 1.0f), 0.0f, 1.0f); };
  material.has_roughness = color.is_object();
  material.metallic = fraction(member(color, "metallicFactor"));
  material.roughness = fraction(member(color, "roughnessFactor"));
  material.normal_scale = number(member(member(json, "normalTexture"), "scale"), 1.0f);
  material.occlusion_strength = fraction(member(member(json, "occlusionTexture"), "strength"));
  const Json& extensions = member(json, "extensions");
  if (extensions.is_object())
    for (const auto& [name, properties] : extensions.items())
      if (is_ignored(name, properties)) material.ignored.push_back(name.substr(kMaterialExtension.size()));
  material.emission_strength =
      std::max(number(member(member(extensions, "KHR_materials_emissive_strength"), "emissiveStrength"), 1.0f), 0.0f);
  material.unlit = member(extensions, "KHR_materials_unlit").is_object();
  material.alpha = number(element(member(color, "baseColorFactor"), 3), 1.0f);
  material.cutoff = number(member(json, "alphaCutoff"), 0.5f);
  if (const std::string mode = text_of(member(json, "alphaMode")); !mode.empty()) material.mode = mode;
  return material;
}

glm::dmat4 matrix_of(const Json& node) {
  const Json& matrix = member(node, "matrix");
  glm::dmat4 m(1.0);
  if (matrix.is_array()) {
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 4; ++row)
        m[column][row] = number(element(matrix, std::size_t(4 * column + row)), column == row ? 1.0f : 0.0f);
    return m;
  }
  const auto part = [&](const char* name, std::size_t k, float fallback) {
    return double(number(element(member(node, name), k), fallback));
  };
  const glm::dquat rotation_of_node(part("rotation", 3, 1.0f), part("rotation", 0, 0.0f), part("rotation", 1, 0.0f),
                                    part("rotation", 2, 0.0f));
  m = glm::mat4_cast(rotation_of_node);
  for (int axis = 0; axis < 3; ++axis) {
    m[axis] *= part("scale", std::size_t(axis), 1.0f);
    m[3][axis] = part("translation", std::size_t(axis), 0.0f);
  }
  return m;
}

/// Adds the camera at a node, if it can be used.
void add_camera(const Json& json, const Json& node, const glm::dmat4& world_from_node, std::vector<View>& cameras) {
  const Json& camera = member(json, "cameras");
  const int index = index_in(member(node, "camera"));
  if (index < 0) return;
  const Json& definition = element(camera, std::size_t(index));
  const glm::dvec3 along = -glm::dvec3(world_from_node[2]), up(world_from_node[1]);
  if (!definition.is_object() || !(glm::length(along) > 0.0) || !(glm::length(up) > 0.0)) return;
  View view;
  view.name = text_of(member(definition, "name"));
  if (view.name.empty()) view.name = text_of(member(node, "name"));
  view.eye = glm::vec3(world_from_node[3]);
  view.target = glm::vec3(glm::dvec3(world_from_node[3]) + glm::normalize(along));
  view.up = glm::vec3(glm::normalize(up));
  if (const Json& parallel = member(definition, "orthographic"); parallel.is_object())
    view.height = 2.0f * number(member(parallel, "ymag"), 1.0f);
  else
    view.angle_deg =
        glm::degrees(number(member(member(definition, "perspective"), "yfov"), glm::radians(view.angle_deg)));
  cameras.push_back(std::move(view));
}

/// Reads the cameras of a scene, in the order of its nodes.
void read_cameras(const Json& json, int scene, std::vector<View>& cameras) {
  const Json& nodes = member(json, "nodes");
  if (!nodes.is_array() || !member(json, "cameras").is_array()) return;
  struct PendingNode {
    int node;
    glm::dmat4 world_from_parent;
  };
  std::vector<PendingNode> stack;
  const auto push_all = [&](const Json& list, const glm::dmat4& parent) {
    if (!list.is_array()) return;
    for (std::size_t k = list.size(); k-- > 0;)
      if (const int node = index_in(list[k]); node >= 0) stack.push_back({node, parent});
  };
  push_all(member(element(member(json, "scenes"), std::size_t(scene)), "nodes"), glm::dmat4(1.0));
  std::vector<bool> visited(nodes.size(), false);  // in an invalid file a node may be its own descendant
  while (!stack.empty()) {
    const PendingNode pending = stack.back();
    stack.pop_back();
    if (std::size_t(pending.node) >= nodes.size() || visited[std::size_t(pending.node)]) continue;
    visited[std::size_t(pending.node)] = true;
    const Json& node = nodes[std::size_t(pending.node)];
    const glm::dmat4 world_from_node = pending.world_from_parent * matrix_of(node);
    add_camera(json, node, world_from_node, cameras);
    push_all(member(node, "children"), world_from_node);
  }
}

}  // namespace

glm::vec2 GltfPlacement::placed(glm::vec2 uv) const {
  // glTF measures v from the top.
  const glm::vec2 scaled = scale * glm::vec2(uv.x, 1.0f - uv.y);
  const float c = std::cos(rotation), s = std::sin(rotation);
  const glm::vec2 rotated(c * scaled.x + s * scaled.y, -s * scaled.x + c * scaled.y);
  return {rotated.x + offset.x, 1.0f - (rotated.y + offset.y)};
}

GltfPlacement GltfMaterial::placement() const {
  for (const auto& map : maps)
    if (map) return *map;
  return {};
}

GltfFacts read_gltf_facts(const std::filesystem::path& file, std::optional<int> scene) {
  GltfFacts facts;
  const Json json = Json::parse(json_text(file), nullptr, false);
  if (!json.is_object()) return facts;
  if (const Json& materials = member(json, "materials"); materials.is_array())
    for (const Json& material : materials) facts.materials.push_back(material_of(material));
  if (const Json& scenes = member(json, "scenes"); scenes.is_array())
    for (const Json& each : scenes) facts.scenes.push_back(text_of(member(each, "name")));
  facts.scene = scene.value_or(std::max(index_in(member(json, "scene")), 0));
  const Json& lights = member(member(member(json, "extensions"), "KHR_lights_punctual"), "lights");
  if (lights.is_array()) facts.lights = int(lights.size());
  read_cameras(json, facts.scene, facts.cameras);
  return facts;
}

std::string gltf_with_scene(const std::filesystem::path& file, int scene) {
  const auto read = read_whole_file(file);
  if (!read) return "";
  const std::string& bytes = *read;
  const std::string old_text = json_text(file);
  Json json = Json::parse(old_text, nullptr, false);
  if (!json.is_object()) return "";
  json["scene"] = scene;
  std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (!bytes.starts_with("glTF")) return text;
  GlbStart start{};
  const std::size_t rest = sizeof start + old_text.size();
  if (bytes.size() < rest) return "";
  std::memcpy(&start, bytes.data(), sizeof start);
  constexpr std::size_t kAlignment = 4;  // alignment of chunks
  text.resize((text.size() + kAlignment - 1) / kAlignment * kAlignment, ' ');
  start.json_length = std::uint32_t(text.size());
  start.length = std::uint32_t(sizeof start + text.size() + bytes.size() - rest);
  std::string changed(sizeof start, '\0');
  std::memcpy(changed.data(), &start, sizeof start);
  return changed.append(text).append(bytes, rest);
}

}  // namespace umbrage
