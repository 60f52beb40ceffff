// Import of models through Assimp. Assimp only parses and triangulates; what it could do beyond that (joining,
// normals, flattening) scene/finish.cpp does faster and by our own rules.
#include "scene/import.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cmath>
#include <cstring>
#include <exception>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <new>
#include <optional>
#include <system_error>

#include "scene/finish.h"
#include "scene/import_materials.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

std::string ending_of(const fs::path& file) {
  std::string ending = file.extension().string();
  if (!ending.empty()) ending.erase(0, 1);
  for (char& c : ending) c = char(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

std::string upper(std::string text) {
  for (char& c : text) c = char(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string list_of_formats() {
  std::string list;
  for (const std::string& format : import_formats()) list += (list.empty() ? "." : ", .") + format;
  return list;
}

/// What can be said of a file before it is parsed.
std::optional<Error> check_file(const fs::path& file, const std::string& format) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (status.type() == fs::file_type::not_found) return file_error("{}: there is no such file", file.string());
  if (error) return file_error("{}: cannot be read ({})", file.string(), error.message());
  if (status.type() == fs::file_type::directory) {
    return file_error("{}: is a folder, where a model file is needed", file.string());
  }
  const auto& formats = import_formats();
  if (std::find(formats.begin(), formats.end(), format) == formats.end()) {
    return file_error("{}: is no model that can be read; files that end in {} can", file.string(), list_of_formats());
  }
  if (status.type() != fs::file_type::regular) return file_error("{}: is not a regular file", file.string());
  if (fs::file_size(file, error) == 0 && !error) return file_error("{}: is empty", file.string());
  if (!std::ifstream(file, std::ios::binary)) {
    return file_error("{}: cannot be opened for reading (permission?)", file.string());
  }
  return std::nullopt;
}

/// The parser's reason without its prefix and line ends, in brackets; or nothing.
std::string reason_of(const char* text) {
  std::string reason = text ? text : "";
  for (char& c : reason) {
    if (std::iscntrl(static_cast<unsigned char>(c))) c = ' ';
  }
  while (!reason.empty() && (reason.back() == ' ' || reason.back() == '.')) reason.pop_back();
  constexpr std::size_t kLongest = 200;
  if (reason.size() > kLongest) reason.resize(kLongest);
  return reason.empty() ? "" : " (" + reason + ")";
}

glm::dmat4 matrix_of(const aiMatrix4x4& m) {
  return glm::transpose(
      glm::dmat4(m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2, m.d3, m.d4));
}

/// One mesh as one node places it. `keep_normals` is off for formats whose normals say no more than the faces do.
Mesh mesh_of(const aiMesh& source, const glm::dmat4& place, bool keep_normals) {
  Mesh mesh;
  mesh.name = source.mName.C_Str();
  mesh.material = int(source.mMaterialIndex);
  const glm::dmat3 turn(place);
  const double determinant = glm::determinant(turn);
  // The cofactor matrix is the inverse transpose but for a factor, and exists for flattening transforms too.
  const glm::dmat3 cofactor(glm::cross(turn[1], turn[2]), glm::cross(turn[2], turn[0]), glm::cross(turn[0], turn[1]));
  const double sign = determinant < 0.0 ? -1.0 : 1.0;
  const bool moves = place != glm::dmat4(1.0);

  mesh.positions.resize(source.mNumVertices);
  for (unsigned i = 0; i < source.mNumVertices; ++i) {
    const aiVector3D& p = source.mVertices[i];
    mesh.positions[i] = moves ? glm::vec3(place * glm::dvec4(p.x, p.y, p.z, 1.0)) : glm::vec3(p.x, p.y, p.z);
  }
  if (keep_normals && source.mNormals && determinant != 0.0) {
    mesh.normals.resize(source.mNumVertices);
    for (unsigned i = 0; i < source.mNumVertices; ++i) {
      const aiVector3D& n = source.mNormals[i];
      if (!moves) {
        mesh.normals[i] = {n.x, n.y, n.z};
        continue;
      }
      const glm::dvec3 turned = sign * (cofactor * glm::dvec3(n.x, n.y, n.z));
      const double length = glm::length(turned);
      mesh.normals[i] = length > 0.0 ? glm::vec3(turned / length) : glm::vec3(0.0f);
    }
  }
  if (source.mTextureCoords[0]) {
    mesh.uvs.resize(source.mNumVertices);
    for (unsigned i = 0; i < source.mNumVertices; ++i) {
      mesh.uvs[i] = {source.mTextureCoords[0][i].x, source.mTextureCoords[0][i].y};
    }
  }
  mesh.indices.reserve(std::size_t(source.mNumFaces) * 3);
  for (unsigned i = 0; i < source.mNumFaces; ++i) {
    const aiFace& face = source.mFaces[i];
    if (face.mNumIndices != 3) continue;
    const bool mirrored = sign < 0.0;
    mesh.indices.push_back(face.mIndices[0]);
    mesh.indices.push_back(face.mIndices[mirrored ? 2 : 1]);
    mesh.indices.push_back(face.mIndices[mirrored ? 1 : 2]);
  }
  return mesh;
}

/// Adds every mesh of every node. Nodes are objects.
void import_nodes(const aiScene& source, bool keep_normals, Scene& scene) {
  struct Place {
    const aiNode* node;
    glm::dmat4 parent;
  };
  std::vector<Place> stack{{source.mRootNode, glm::dmat4(1.0)}};
  int object = 0;
  while (!stack.empty()) {
    const Place place = stack.back();
    stack.pop_back();
    if (!place.node) continue;
    const glm::dmat4 here = place.parent * matrix_of(place.node->mTransformation);
    bool has_mesh = false;
    for (unsigned i = 0; i < place.node->mNumMeshes; ++i) {
      const unsigned index = place.node->mMeshes[i];
      if (index >= source.mNumMeshes) continue;
      Mesh mesh = mesh_of(*source.mMeshes[index], here, keep_normals);
      if (mesh.indices.empty()) continue;
      if (mesh.name.empty()) mesh.name = place.node->mName.C_Str();
      mesh.object = object;
      has_mesh = true;
      scene.meshes.push_back(std::move(mesh));
    }
    if (has_mesh) ++object;
    for (unsigned i = place.node->mNumChildren; i-- > 0;) stack.push_back({place.node->mChildren[i], here});
  }
}

/// Vertex colours cannot be kept; one colour for a whole mesh can, as a material of its own.
void import_vertex_colors(const aiScene& source, Scene& scene) {
  bool ignored = false;
  for (unsigned i = 0; i < source.mNumMeshes; ++i) ignored = ignored || source.mMeshes[i]->mColors[0] != nullptr;
  if (ignored) scene.warnings.push_back("the colours at the vertices are not used; surfaces show their material");
}

Result<Scene> import_checked(const fs::path& file, const std::string& format, const ImportSettings& settings) {
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_ANIMATIONS, false);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_CAMERAS, false);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_LIGHTS, false);
  const aiScene* source = importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_SortByPType);
  if (!source) {
    return file_error("{}: is not a {} file that can be read{}", file.string(), upper(format),
                      reason_of(importer.GetErrorString()));
  }
  Scene scene;
  scene.name = file.filename().string();
  scene.up = format == "stl" ? glm::vec3(0.0f, 0.0f, 1.0f) : glm::vec3(0.0f, 1.0f, 0.0f);
  if (const float length = glm::length(settings.up); length > 0.0f && std::isfinite(length)) {
    scene.up = settings.up / length;
  }
  import_materials(*source, file, format, scene);
  import_nodes(*source, format != "stl", scene);
  import_vertex_colors(*source, scene);
  importer.FreeScene();

  if (scene.meshes.empty()) return file_error("{}: has no triangles", file.string());
  const std::size_t triangles = scene.triangle_count();
  const std::size_t dropped = finish_scene(scene, settings.crease_angle_deg);
  if (scene.meshes.empty()) {
    return file_error("{}: has no triangles that can be drawn; all {} are degenerate or not finite", file.string(),
                      triangles);
  }
  constexpr std::size_t kWorthSaying = 100;  // one in a hundred; fewer are common and do not show
  if (dropped * kWorthSaying > triangles) {
    scene.warnings.push_back(
        fmt::format("{} of {} triangles are degenerate or not finite and are left out", dropped, triangles));
  }
  return scene;
}

}  // namespace

const std::vector<std::string>& import_formats() {
  static const std::vector<std::string> formats{"obj", "ply", "stl", "gltf", "glb", "3ds", "dae", "fbx", "off"};
  return formats;
}

Result<Scene> import_scene(const fs::path& file, const ImportSettings& settings) {
  const std::string format = ending_of(file);
  if (auto error = check_file(file, format)) return std::move(*error);
  try {
    return import_checked(file, format, settings);
  } catch (const std::bad_alloc&) {
    return file_error("{}: needs more memory than there is, or is broken", file.string());
  } catch (const std::exception& e) {
    return file_error("{}: is not a {} file that can be read{}", file.string(), upper(format), reason_of(e.what()));
  } catch (...) {
    return file_error("{}: is not a {} file that can be read", file.string(), upper(format));
  }
}

}  // namespace umbrage
