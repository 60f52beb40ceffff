// Import of models: OBJ, PLY, OFF, STL, 3MF, FBX, VTK and points in text form by our own readers, PDB through Gemmi,
// all other formats through Assimp. Assimp only parses and triangulates; scene/finish.cpp joins vertices and creates
// normals, which is faster and gives all formats the same rules.
#include "importer/importer.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <cctype>
#include <charconv>
#include <cstring>
#include <exception>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <string_view>
#include <system_error>

#include "importer/common/placed_mesh.h"
#include "importer/import_materials.h"
#include "importer/readers.h"
#include "scene/readers/content.h"
#include "scene/readers/import_parts.h"
#include "scene/readers/model_readers.h"
#include "scene/readers/vertex_colors.h"
#include "scene/readers/whole_file.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

std::string upper(std::string text) {
  for (char& c : text) c = char(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

/// Returns the reason why Assimp failed, for users: known reasons are reworded, others lose Assimp's prefixes.
std::string reason_of(std::string reason) {
  struct Known {
    const char *theirs, *ours;
  };
  static constexpr Known kKnown[] = {
      {"No suitable reader", "its content is of another format, or cut short"},
      {"No scene", "it contains no scene"},
      {"Cannot parse string", "a number is missing"},
  };
  for (const Known& known : kKnown) {
    if (reason.find(known.theirs) != std::string::npos) reason = known.ours;
  }
  if (const auto colon = reason.find(": "); colon != std::string::npos && reason.find(' ') > colon) {
    reason.erase(0, colon + 2);
  }
  for (char& c : reason) {
    if (std::iscntrl(static_cast<unsigned char>(c))) c = ' ';
  }
  while (!reason.empty() && (reason.back() == ' ' || reason.back() == '.')) reason.pop_back();
  constexpr std::size_t kMaxLength = 160;
  if (reason.size() > kMaxLength) reason.resize(kMaxLength);
  return reason.empty() ? "" : " (" + reason + ")";
}

/// Returns whether Assimp's error means that the file has no triangles; it has several messages for that.
bool means_no_triangles(const std::string& reason) {
  for (const char* theirs : {"No meshes remaining", "has no faces", "primitive type: empty", "contains no meshes"}) {
    if (reason.find(theirs) != std::string::npos) return true;
  }
  return false;
}

Error unreadable(const fs::path& file, const std::string& format, const std::string& reason) {
  if (means_no_triangles(reason)) return file_error("'{}' has no triangles", file.string());
  return file_error("'{}' cannot be read as {}{}", file.string(), upper(format), reason_of(reason));
}

std::string text_of(const fs::path& file) {
  auto text = read_whole_file(file);
  return text ? std::move(*text) : std::string();
}

/// Returns the integer attribute `name` of an XML tag, as in `count="3"`; nothing if it is missing or not a number.
std::optional<std::uint64_t> attribute_of(std::string_view tag, const std::string& name) {
  const std::size_t at = tag.find(name + "=");
  if (at == std::string_view::npos || at + name.size() + 2 > tag.size()) return std::nullopt;
  tag.remove_prefix(at + name.size() + 2);  // '=' and the quotation mark
  std::uint64_t value = 0;
  const auto [stop, error] = std::from_chars(tag.data(), tag.data() + tag.size(), value);
  if (error != std::errc() || stop == tag.data()) return std::nullopt;
  return value;
}

/// Checks a DAE file for errors that Assimp cannot handle: with other content in lists of indices it loops forever;
/// with counts larger than the data it reads out of bounds.
std::optional<Error> check_dae(const fs::path& file) {
  const std::string text = text_of(file);
  for (std::string_view tag : {"p", "ph", "h", "v", "vcount"}) {
    const std::string open = "<" + std::string(tag);
    for (std::size_t at = text.find(open); at != std::string::npos; at = text.find(open, at + 1)) {
      const char after = at + open.size() < text.size() ? text[at + open.size()] : '\0';
      if (after != '>' && !std::isspace(static_cast<unsigned char>(after))) continue;  // another tag
      const std::size_t begin = text.find('>', at);
      const std::size_t wrong = text.find_first_not_of("0123456789- \t\r\n>", begin);
      if (begin == std::string::npos || (wrong != std::string::npos && text[wrong] == '<')) continue;
      return file_error("'{}' cannot be read as DAE (the index list <{}> contains something other than integers)",
                        file.string(), tag);
    }
  }
  const auto tag_at = [&](std::size_t at) { return std::string_view(text).substr(at, text.find('>', at) - at); };
  constexpr const char* kArray = "<float_array";
  for (std::size_t at = text.find(kArray); at != std::string::npos; at = text.find(kArray, at + 1)) {
    const std::optional<std::uint64_t> numbers = attribute_of(tag_at(at), "count");
    if (!numbers || *numbers > text.size() - at) {
      return file_error("'{}' cannot be read as DAE (a <float_array> has no count, or a wrong one)", file.string());
    }
    const std::size_t accessor = text.find("<accessor", at);
    if (accessor == std::string::npos || accessor > text.find("</source>", at)) continue;
    const std::string_view tag = tag_at(accessor);
    const std::uint64_t count = attribute_of(tag, "count").value_or(*numbers + 1),
                        stride = attribute_of(tag, "stride").value_or(1),
                        offset = attribute_of(tag, "offset").value_or(0);
    const bool fits =
        count <= *numbers && stride <= *numbers && offset <= *numbers && count * stride + offset <= *numbers;
    if (!fits) {
      return file_error("'{}' cannot be read as DAE (an <accessor> refers past the {} numbers of its array)",
                        file.string(), *numbers);
    }
  }
  return std::nullopt;
}

/// File access for Assimp. If `text` is not empty, it replaces the content of the model's file.
struct Files : Assimp::DefaultIOSystem {
  std::string model, text;
  Files(std::string model, std::string text) : model(std::move(model)), text(std::move(text)) {}
  bool Exists(const char* name) const override {
    return (!text.empty() && name == model) || Assimp::DefaultIOSystem::Exists(name);
  }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    if (!text.empty() && name == model) {
      return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    }
    std::error_code error;
    if (!fs::is_regular_file(name, error)) return nullptr;  // a name in a model may be a pipe, which never ends
    if (name != model) raise_limits_for(name);
    return Assimp::DefaultIOSystem::Open(name, mode);
  }
};

/// Detects that Assimp has dropped faces with indices out of range, which it reports only in its log. The log is global
/// to the process, so there must be only one import at a time.
struct DroppedFaces : Assimp::LogStream {
  bool& dropped;
  explicit DroppedFaces(bool& dropped) : dropped(dropped) {}
  void write(const char* message) override { dropped = dropped || std::strstr(message, "out-of-range indices"); }
};

struct Log {
  bool dropped_faces = false;
  Log() {
    constexpr int kNoDefaultStreams = 0;
    Assimp::DefaultLogger::create(nullptr, Assimp::Logger::NORMAL, kNoDefaultStreams);
    // attachStream takes ownership.
    Assimp::DefaultLogger::get()->attachStream(new DroppedFaces(dropped_faces), Assimp::Logger::Warn);
  }
  ~Log() { Assimp::DefaultLogger::kill(); }
};

glm::dmat4 matrix_of(const aiMatrix4x4& m) {
  return glm::transpose(
      glm::dmat4(m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2, m.d3, m.d4));
}

bool is_points(const aiMesh& source) { return source.mPrimitiveTypes == aiPrimitiveType_POINT; }

bool all_white(const aiMesh& source) {
  return std::all_of(source.mColors[0], source.mColors[0] + source.mNumVertices,
                     [](const aiColor4D& c) { return c.r == 1.0f && c.g == 1.0f && c.b == 1.0f; });
}

/// Rules for converting meshes.
struct MeshRules {
  bool keep_normals = true;    ///< false for formats whose normals contain no more than the face normals
  bool linear_colors = false;  ///< otherwise vertex colours are sRGB
};

/// Converts a mesh, in the space of its node.
Mesh mesh_of(const aiMesh& source, const MeshRules& rules) {
  Mesh mesh;
  mesh.name = source.mName.C_Str();
  mesh.material = int(source.mMaterialIndex);
  const auto vectors_of = [&](const aiVector3D* from) {
    std::vector<glm::vec3> vectors(source.mNumVertices);
    for (unsigned i = 0; i < source.mNumVertices; ++i) vectors[i] = {from[i].x, from[i].y, from[i].z};
    return vectors;
  };
  mesh.positions = vectors_of(source.mVertices);
  if (rules.keep_normals && source.mNormals) mesh.normals = vectors_of(source.mNormals);
  if (const aiVector3D* uvs = source.mTextureCoords[0]) {
    mesh.uvs.resize(source.mNumVertices);
    for (unsigned i = 0; i < source.mNumVertices; ++i) mesh.uvs[i] = {uvs[i].x, uvs[i].y};
  }
  if (source.mColors[0] && !all_white(source)) {
    mesh.colors.resize(source.mNumVertices);
    for (unsigned i = 0; i < source.mNumVertices; ++i) {
      const aiColor4D& c = source.mColors[0][i];
      mesh.colors[i] = rules.linear_colors ? glm::vec3(c.r, c.g, c.b) : linear_color(glm::vec3(c.r, c.g, c.b));
    }
  }
  mesh.points = is_points(source);
  if (mesh.points) return mesh;
  mesh.indices.reserve(std::size_t(source.mNumFaces) * 3);
  for (unsigned i = 0; i < source.mNumFaces; ++i) {
    const aiFace& face = source.mFaces[i];
    if (face.mNumIndices == 3) mesh.indices.insert(mesh.indices.end(), face.mIndices, face.mIndices + 3);
  }
  return mesh;
}

/// A node and its transform.
struct PlacedNode {
  const aiNode* node;
  glm::dmat4 world_from_node;
};

/// Places a mesh by its node, or by the nodes that its bones name.
PlacedMesh place_mesh(const aiMesh& source, const PlacedNode& at, const std::map<std::string, glm::dmat4>& worlds,
                      const MeshRules& rules) {
  std::vector<BlendedTransform> transforms(source.mNumBones > 0 ? source.mNumVertices : 0);
  for (unsigned b = 0; b < source.mNumBones; ++b) {
    const aiBone& bone = *source.mBones[b];
    const auto world = worlds.find(bone.mName.C_Str());
    if (world == worlds.end()) continue;
    const glm::dmat4 transform = world->second * matrix_of(bone.mOffsetMatrix);
    for (unsigned k = 0; k < bone.mNumWeights; ++k)
      if (bone.mWeights[k].mVertexId < source.mNumVertices)
        transforms[bone.mWeights[k].mVertexId].add(double(bone.mWeights[k].mWeight), transform);
  }
  if (transforms.empty()) return placed(mesh_of(source, rules), at.world_from_node);
  return skinned(mesh_of(source, rules), [&](std::size_t i) { return transforms[i].mean_or(at.world_from_node); });
}

/// Adds every mesh of every node, transformed by `root`; points only if there are no triangles. Each node is an object.
void import_nodes(const aiScene& source, const glm::dmat4& root, const MeshRules& rules, Scene& scene) {
  std::vector<PlacedNode> nodes, stack{{source.mRootNode, root}};
  std::map<std::string, glm::dmat4> worlds;
  while (!stack.empty()) {
    PlacedNode at = stack.back();
    stack.pop_back();
    if (!at.node) continue;
    at.world_from_node = at.world_from_node * matrix_of(at.node->mTransformation);
    nodes.push_back(at);
    worlds.emplace(at.node->mName.C_Str(), at.world_from_node);
    for (unsigned i = at.node->mNumChildren; i-- > 0;) stack.push_back({at.node->mChildren[i], at.world_from_node});
  }
  const bool only_points = std::all_of(source.mMeshes, source.mMeshes + source.mNumMeshes,
                                       [](const aiMesh* mesh) { return is_points(*mesh); });
  std::vector<PlacedMesh> meshes;
  int object = 0;
  for (const PlacedNode& at : nodes) {
    bool has_mesh = false;
    for (unsigned i = 0; i < at.node->mNumMeshes; ++i) {
      const unsigned index = at.node->mMeshes[i];
      if (index >= source.mNumMeshes || (is_points(*source.mMeshes[index]) && !only_points)) continue;
      PlacedMesh made = place_mesh(*source.mMeshes[index], at, worlds, rules);
      if (made.mesh.indices.empty() && !made.mesh.points) continue;
      if (made.mesh.name.empty()) made.mesh.name = at.node->mName.C_Str();
      made.mesh.object = object;
      has_mesh = true;
      meshes.push_back(std::move(made));
    }
    if (has_mesh) ++object;
  }
  move_to_scene(std::move(meshes), scene);
}

Result<Scene> import_by_assimp(const fs::path& file, const std::string& format, bool process_ends) {
  if (format == "dae") {
    if (auto error = check_dae(file)) return std::move(*error);
  }
  // Text for Assimp in place of the file.
  std::string changed = format == "dae" ? with_dae_morphs(text_of(file)) : std::string();
  const bool is_renamed = import_format(file) != format;
  if (changed.empty() && (is_gzip_file(file) || is_renamed)) {
    auto text = read_whole_file(file);
    if (!text) return text.error();
    changed = std::move(*text);
  }
  const bool is_gltf = format == "gltf" || format == "glb";  // of version 1.0
  MeshRules rules;
  auto owner = std::make_unique<Assimp::Importer>();
  // Freeing the importer's faces one by one takes a tenth of the import time.
  Assimp::Importer& importer = process_ends ? *owner.release() : *owner;
  // Assimp selects the reader by the extension.
  const std::string name = without_gz(file).string() + (is_renamed ? "." + format : "");
  importer.SetIOHandler(new Files(name, std::move(changed)));  // takes ownership
  // In formats other than glTF, points are what remains of invalid faces.
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_LINE | (is_gltf ? 0 : aiPrimitiveType_POINT));
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  const Log log;
  const aiScene* source = importer.ReadFile(name, aiProcess_Triangulate | aiProcess_SortByPType);
  if (!source || !source->mRootNode) return unreadable(file, format, importer.GetErrorString());
  Scene scene;
  scene.has_front = is_gltf || format == "dae";
  import_materials(*source, file, format, scene);
  // 3DS files contain no normals, and the normals that Assimp creates ignore creases.
  rules.keep_normals = format != "3ds";
  // Assimp rotates 3DS files as if +z were up. Existing files have +y up, so the rotation is undone.
  const glm::dmat4 root =
      format == "3ds" ? glm::inverse(matrix_of(source->mRootNode->mTransformation)) : glm::dmat4(1.0);
  rules.linear_colors = is_gltf;
  import_nodes(*source, root, rules, scene);
  if (log.dropped_faces) {
    scene.warnings.push_back("some triangles have vertex indices out of range and are left out");
  }
  return scene;
}

Result<Scene> import_obj(const fs::path& path) {
  const Result<ObjFile> file = open_obj(path);
  if (!file) return file.error();
  for (const fs::path& library : file->libraries) raise_limits_for(library);
  constexpr bool kThreads = false;  // the memory limits of this process leave no room for them
  Result<ObjScene> obj = read_obj(*file, kThreads);
  if (!obj) return obj.error();
  import_obj_maps(*file, *obj);
  warn_of_ignored(obj->scene);
  return std::move(obj->scene);
}

Result<Scene> import_ply(const fs::path& file, const std::optional<std::string>& field) {
  std::vector<std::string> textures;
  Result<Scene> scene = read_ply(file, field, textures);
  if (!scene) return scene;
  for (std::size_t i = 0; i < std::min(textures.size(), scene->materials.size()); ++i) {
    const int texture = import_texture(file, textures[i], *scene);
    scene->materials[i].texture = texture;
    if (texture != kNoTexture) scene->materials[i].albedo = glm::vec3(1.0f);
  }
  return scene;
}

}  // namespace

Result<Scene> import_in_process(const fs::path& file, const ImportSettings& settings, bool process_ends) {
  const std::string format = format_of_file(file);
  if (auto error = check_model_file(file, format)) return std::move(*error);
  try {
    if (is_gzip_file(file)) {
      const auto size = inflated_size_of(file);
      if (!size) return size.error();
      raise_limits_by(double(*size));
    }
    const bool is_gltf = format == "gltf" || format == "glb",
               is_vtk = format == "vtk" || format == "vtp" || format == "vtu";
    std::optional<Result<Scene>> gltf = is_gltf ? read_gltf(file, settings) : std::nullopt;
    Result<Scene> scene = gltf                                 ? std::move(*gltf)
                          : format == "obj"                    ? import_obj(file)
                          : format == "ply"                    ? import_ply(file, settings.field)
                          : format == "off"                    ? read_off(file)
                          : format == "stl"                    ? read_stl(file)
                          : format == "xyz" || format == "pts" ? read_xyz(file, settings.field)
                          : format == "3mf"                    ? read_3mf(file)
                          : format == "fbx"                    ? read_fbx(file)
                          : format == "pdb" || format == "ent" ? read_pdb(file, settings.field)
                          : is_vtk                             ? read_vtk(file, settings.field)
                                                               : import_by_assimp(file, format, process_ends);
    if (process_ends) return scene;
    return complete_import(std::move(scene), file, settings);
  } catch (const std::bad_alloc&) {
    return too_large_to_read(file);
  } catch (const std::exception& e) {
    return unreadable(file, format, e.what());
  } catch (...) {
    return unreadable(file, format, "");
  }
}

}  // namespace umbrage
