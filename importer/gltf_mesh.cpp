
#include <algorithm>
#include <cmath>

#include "importer/gltf_parts.h"

namespace umbrage {
namespace {

/// Modes of primitives, by OpenGL's numbers.
enum Mode { kPoints, kLines, kLineLoop, kLineStrip, kTriangles, kTriangleStrip, kTriangleFan };

constexpr const char* kDraco = "KHR_draco_mesh_compression";

/// A primitive that is being read.
struct Reader {
  GltfFile& file;
  const Json& primitive;
  std::string name;  ///< of the mesh, for messages
  DracoPrimitive draco = {};
  bool is_draco = false;

  bool has(const char* attribute) const { return !member(member(primitive, "attributes"), attribute).is_null(); }
  const Json& accessor_of(const char* attribute) const {
    const int index = index_of(member(member(primitive, "attributes"), attribute));
    return file.list("accessors", std::size_t(index));
  }
  Result<GltfNumbers> read(const char* attribute, int min_width, int max_width) {
    if (const auto found = draco.attributes.find(attribute); found != draco.attributes.end()) {
      if (found->second.width < min_width || found->second.width > max_width)
        return file_error("its attribute {} has {} components", attribute, found->second.width);
      return std::move(found->second);
    }
    return read_numbers(file, index_of(member(member(primitive, "attributes"), attribute)), min_width, max_width);
  }
  /// Reads an attribute of `count` elements that may be missing; if it cannot be used, it is left out with a warning.
  std::optional<GltfNumbers> read_optional(const char* attribute, int min_width, int max_width, std::size_t count) {
    if (!has(attribute)) return std::nullopt;
    auto numbers = read(attribute, min_width, max_width);
    std::string reason;
    if (!numbers)
      reason = numbers.error().message;
    else if (numbers->count < count)
      reason = fmt::format("it has {} elements for {} vertices", numbers->count, count);
    if (reason.empty()) return std::move(*numbers);
    file.warn_once(attribute, fmt::format("{} of the mesh '{}' cannot be used: {}", attribute, name, reason));
    return std::nullopt;
  }
};

std::vector<glm::vec3> vectors_of(const GltfNumbers& numbers, std::size_t count) {
  std::vector<glm::vec3> vectors(count);
  for (std::size_t i = 0; i < count; ++i) vectors[i] = {numbers.at(i)[0], numbers.at(i)[1], numbers.at(i)[2]};
  return vectors;
}

void read_uvs(Reader& reader, GltfPlacement placement, Mesh& mesh) {
  const auto attribute_of = [](int set) { return fmt::format("TEXCOORD_{}", set); };
  if (!reader.has(attribute_of(placement.set).c_str())) placement.set = 0;
  const auto uvs = reader.read_optional(attribute_of(placement.set).c_str(), 2, 2, mesh.positions.size());
  if (!uvs) return;
  mesh.uvs.resize(mesh.positions.size());
  for (std::size_t i = 0; i < mesh.uvs.size(); ++i) mesh.uvs[i] = placement.placed({uvs->at(i)[0], uvs->at(i)[1]});
}

/// Warns if texture coordinates extend past the border of a texture that is clamped or mirrored there.
void warn_of_borders(Reader& reader, const Mesh& mesh) {
  constexpr float kTolerance = 0.01f;
  for (const glm::vec2& uv : mesh.uvs)
    for (int axis = 0; axis < 2; ++axis)
      if (uv[axis] < -kTolerance || uv[axis] > 1.0f + kTolerance)
        return reader.file.warn_once("borders", fmt::format("a texture of the mesh '{}' is clamped or mirrored at its "
                                                            "border; all textures are drawn repeated",
                                                            reader.name));
}

void read_colors(Reader& reader, GltfPrimitive& primitive) {
  Mesh& mesh = primitive.mesh;
  auto colors = reader.read_optional("COLOR_0", 3, 4, mesh.positions.size());
  if (!colors) return;
  // The standard wants integers to be normalised; a file that does not say so means it.
  const Json& accessor = reader.accessor_of("COLOR_0");
  const Json& flag = member(accessor, "normalized");
  if (!flag.is_boolean() || !flag.get<bool>())
    for (float& v : colors->values) v = normalized(double(v), index_of(member(accessor, "componentType")));
  mesh.colors.resize(mesh.positions.size());
  for (std::size_t i = 0; i < mesh.colors.size(); ++i) {
    const float* c = colors->at(i);
    for (int k = 0; k < 3; ++k) mesh.colors[i][k] = c[k] >= 0.0f && std::isfinite(c[k]) ? c[k] : 0.0f;
    primitive.has_alpha = primitive.has_alpha || (colors->width == 4 && c[3] < 1.0f);
  }
}

/// Reads the attributes of the application, such as "_PRESSURE", that are wanted as fields: see ImportSettings.
void read_fields(Reader& reader, const std::optional<std::string>& wanted, Mesh& mesh) {
  const Json& attributes = member(reader.primitive, "attributes");
  if (!wanted || !attributes.is_object()) return;
  constexpr int kMaxWidth = 4;
  for (const auto& [name, accessor] : attributes.items()) {
    if (!name.starts_with('_') || (!wanted->empty() && name != *wanted)) continue;
    const auto numbers = reader.read_optional(name.c_str(), 1, kMaxWidth, mesh.positions.size());
    if (!numbers) continue;
    Field field{.name = name, .components = numbers->width, .values = {}};
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
      field.values.insert(field.values.end(), numbers->at(i), numbers->at(i) + numbers->width);
    mesh.fields.push_back(std::move(field));
  }
}

/// Adds the displacements of the morph targets.
void apply_morphs(Reader& reader, const std::vector<float>& weights, Mesh& mesh) {
  const Json& targets = member(reader.primitive, "targets");
  for (std::size_t t = 0; t < std::min(count_of(targets), weights.size()); ++t) {
    if (weights[t] == 0.0f || !std::isfinite(weights[t])) continue;
    const auto add = [&](const char* attribute, std::vector<glm::vec3>& to) {
      const Json& index = member(targets[t], attribute);
      if (index.is_null() || to.empty()) return;
      const auto deltas = read_numbers(reader.file, index_of(index), 3, 4);
      if (!deltas || deltas->count < to.size()) {
        reader.file.warn_once("target", fmt::format("a morph target of the mesh '{}' cannot be used: {}", reader.name,
                                                    deltas ? "it has too few elements" : deltas.error().message));
        return;
      }
      for (std::size_t i = 0; i < to.size(); ++i) {
        const float* d = deltas->at(i);
        to[i] += weights[t] * glm::vec3(d[0], d[1], d[2]);
      }
    };
    add("POSITION", mesh.positions);
    add("NORMAL", mesh.normals);
    add("COLOR_0", mesh.colors);
  }
  if (!mesh.normals.empty())
    for (glm::vec3& n : mesh.normals)
      if (const float length = glm::length(n); length > 0.0f) n /= length;
}

/// Adds the triangles of a list of vertices by the primitive's mode, without those that are out of range.
void add_triangles(int mode, const std::vector<std::uint32_t>& list, std::size_t vertices, Mesh& mesh,
                   GltfCounts& counts) {
  const std::size_t size = list.size();
  const std::size_t triangles = mode == kTriangles ? size / 3 : size < 3 ? 0 : size - 2;
  mesh.indices.reserve(3 * triangles);
  for (std::size_t k = 0; k < triangles; ++k) {
    std::uint32_t a = 0, b = 0, c = 0;
    if (mode == kTriangles) {
      a = list[3 * k], b = list[3 * k + 1], c = list[3 * k + 2];
    } else if (mode == kTriangleFan) {
      a = list[k + 1], b = list[k + 2], c = list[0];
    } else {
      a = list[k], b = list[k + 1 + k % 2], c = list[k + 2 - k % 2];
    }
    ++counts.triangles;
    if (std::max({a, b, c}) >= vertices)
      ++counts.out_of_range;
    else
      mesh.indices.insert(mesh.indices.end(), {a, b, c});
  }
}

/// Returns the primitive's indices; if it has none, those of all vertices. Errors: kFile.
Result<std::vector<std::uint32_t>> indices_of(Reader& reader, std::size_t vertices) {
  if (reader.is_draco) return std::move(reader.draco.indices);
  if (const Json& indices = member(reader.primitive, "indices"); !indices.is_null())
    return read_indices(reader.file, index_of(indices));
  std::vector<std::uint32_t> all(vertices);
  for (std::size_t i = 0; i < vertices; ++i) all[i] = std::uint32_t(i);
  return all;
}

void read_joints(Reader& reader, GltfPrimitive& primitive) {
  constexpr int kMaxSets = 8;
  for (int set = 0; set < kMaxSets; ++set) {
    const std::string joints = fmt::format("JOINTS_{}", set), weights = fmt::format("WEIGHTS_{}", set);
    if (!reader.has(joints.c_str()) || !reader.has(weights.c_str())) break;
    auto j = reader.read_optional(joints.c_str(), 4, 4, primitive.mesh.positions.size());
    auto w = reader.read_optional(weights.c_str(), 4, 4, primitive.mesh.positions.size());
    if (!j || !w) break;
    primitive.joints.push_back(std::move(*j));
    primitive.weights.push_back(std::move(*w));
  }
}

int material_of(Reader& reader, const GltfMeshRules& rules) {
  const Json& material = member(reader.primitive, "material");
  const int index = index_of(material);
  if (index >= 0 && index < rules.default_material) return index;
  if (!material.is_null())
    reader.file.warn_once("material", fmt::format("the mesh '{}' refers to a material that the file does not have; "
                                                  "the standard's default is shown",
                                                  reader.name));
  return rules.default_material;
}

}  // namespace

glm::vec2 GltfPlacement::placed(glm::vec2 uv) const {
  if (offset == glm::vec2(0.0f) && scale == glm::vec2(1.0f) && rotation == 0.0f) return {uv.x, 1.0f - uv.y};
  const glm::vec2 scaled = scale * uv;
  const float c = std::cos(rotation), s = std::sin(rotation);
  const glm::vec2 rotated(c * scaled.x + s * scaled.y, -s * scaled.x + c * scaled.y);
  return {rotated.x + offset.x, 1.0f - (rotated.y + offset.y)};
}

Result<GltfPrimitive> read_primitive(GltfFile& file, const Json& json, std::size_t index,
                                     const std::vector<float>& morph_weights, const GltfMeshRules& rules,
                                     GltfCounts& counts) {
  Reader reader{file, element(member(json, "primitives"), index), text_of(member(json, "name"))};
  const Json& mode_value = member(reader.primitive, "mode");
  const int mode = mode_value.is_null() ? int(kTriangles) : index_of(mode_value);
  if (mode == kLines || mode == kLineLoop || mode == kLineStrip) {
    file.warn_once("lines", "the file's lines are not drawn");
    return file_error("");
  }
  if (mode < 0 || mode > kTriangleFan) return file_error("the mesh '{}' has the unknown mode {}", reader.name, mode);
  if (extension_of(reader.primitive, kDraco).is_object()) {
    auto draco = decode_draco(file, reader.primitive);
    if (!draco) return draco.error();
    reader.draco = std::move(*draco);
    reader.is_draco = true;
  }
  auto positions = reader.read("POSITION", 3, 3);
  if (!positions) return positions.error();
  GltfPrimitive primitive;
  Mesh& mesh = primitive.mesh;
  mesh.name = reader.name;
  mesh.material = material_of(reader, rules);
  mesh.positions = vectors_of(*positions, positions->count);
  const std::size_t count = mesh.positions.size();
  if (const auto normals = reader.read_optional("NORMAL", 3, 3, count)) mesh.normals = vectors_of(*normals, count);
  const bool has_placement = std::size_t(mesh.material) < rules.placements.size();
  mesh.points = mode == kPoints;
  if (!mesh.points)
    read_uvs(reader, has_placement ? rules.placements[std::size_t(mesh.material)] : GltfPlacement{}, mesh);
  if (std::size_t(mesh.material) < rules.has_borders.size() && rules.has_borders[std::size_t(mesh.material)])
    warn_of_borders(reader, mesh);
  read_colors(reader, primitive);
  read_fields(reader, rules.field, mesh);
  apply_morphs(reader, morph_weights, mesh);
  const auto is_white = [](const glm::vec3& color) { return color == glm::vec3(1.0f); };
  if (std::all_of(mesh.colors.begin(), mesh.colors.end(), is_white)) mesh.colors.clear();
  read_joints(reader, primitive);
  if (mesh.points) return primitive;
  const auto indices = indices_of(reader, count);
  if (!indices) return indices.error();
  // What Draco decodes are triangles, also of a strip.
  add_triangles(reader.is_draco ? int(kTriangles) : mode, *indices, count, mesh, counts);
  if (mesh.normals.empty() && rules.flat) mesh.smoothing.assign(mesh.indices.size() / 3, 0);
  if (mesh.indices.empty()) return file_error("the mesh '{}' has no triangles", reader.name);
  return primitive;
}

PlacedMesh skinned(const GltfPrimitive& primitive, const std::vector<glm::dmat4>& world_from_bind) {
  return skinned(primitive.mesh, [&](std::size_t i) {
    BlendedTransform blended;
    for (std::size_t set = 0; set < primitive.joints.size(); ++set)
      for (int k = 0; k < 4; ++k) {
        const float joint = primitive.joints[set].at(i)[k];
        if (joint >= 0.0f && joint < float(world_from_bind.size()))
          blended.add(double(primitive.weights[set].at(i)[k]), world_from_bind[std::size_t(joint)]);
      }
    return blended.mean_or(world_from_bind.empty() ? glm::dmat4(1.0) : world_from_bind[0]);
  });
}

}  // namespace umbrage
