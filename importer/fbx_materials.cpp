// Materials of FBX files, as those of Assimp, which importer/import_materials.cpp converts for all formats.
#include <assimp/material.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>

#include "core/lowercase.h"
#include "importer/fbx_parts.h"
#include "importer/gltf_file.h"
#include "importer/import_materials.h"

namespace umbrage {
namespace {

void add_number(double value, const char* key, unsigned type, unsigned index, aiMaterial& to) {
  const auto number = float(value);
  to.AddProperty(&number, 1, key, type, index);
}

void add_color(const std::optional<glm::dvec3>& value, const char* key, unsigned type, unsigned index, aiMaterial& to) {
  if (!value) return;
  const aiColor3D color(float(value->x), float(value->y), float(value->z));
  to.AddProperty(&color, 1, key, type, index);
}

bool has(const FbxObject& object, std::string_view name) { return !object.property(name).values.empty(); }

/// Returns a colour, such as DiffuseColor, times its factor.
std::optional<glm::dvec3> color_of(const FbxObject& material, const std::string& name) {
  if (has(material, name + "Color")) return material.vector(name + "Color", {}) * material.number(name + "Factor", 1.0);
  return has(material, name) ? std::optional(material.vector(name, {})) : std::nullopt;
}

/// The properties of materials that may have a texture.
struct TexturedProperty {
  const char* name;
  aiTextureType type;
};
constexpr TexturedProperty kTextured[] = {{"DiffuseColor", aiTextureType_DIFFUSE},
                                          {"TransparentColor", aiTextureType_OPACITY},
                                          {"TransparencyFactor", aiTextureType_OPACITY},
                                          {"EmissiveColor", aiTextureType_EMISSIVE},
                                          {"Maya|TEX_color_map", aiTextureType_BASE_COLOR},
                                          {"Maya|baseColor", aiTextureType_BASE_COLOR},
                                          {"3dsMax|Parameters|base_color_map", aiTextureType_BASE_COLOR},
                                          {"3dsMax|main|base_color_map", aiTextureType_BASE_COLOR}};
constexpr const char* kBaseColors[] = {"Maya|baseColor", "3dsMax|Parameters|base_color", "3dsMax|main|basecolor"};

/// Collects the images inside the file.
class Images {
 public:
  /// Returns the name of a texture's image.
  std::string name_of(const FbxObject& texture) {
    if (!texture.record) return {};
    std::string_view path = (*texture.record)["RelativeFilename"].text();
    if (path.empty()) path = (*texture.record)["FileName"].text();
    const std::string name(path);
    const std::vector<FbxObject*> videos = texture.parts("Video");
    if (!videos.empty()) add(name, (*videos[0]->record)["Content"]);
    return name;
  }
  std::vector<std::unique_ptr<aiTexture>> images;

 private:
  void add(const std::string& name, const FbxRecord& content) {
    std::string bytes;
    for (const FbxValue& value : content.values) bytes += value.text;
    if (bytes.empty() || !known_.insert(name).second) return;
    const auto is_of_text = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || std::strchr("+/=", c); };
    if (std::all_of(bytes.begin(), bytes.end(), is_of_text))
      if (const auto decoded = from_base64(bytes)) bytes.assign(decoded->begin(), decoded->end());
    auto image = std::make_unique<aiTexture>();
    image->mFilename = name;
    image->mWidth = unsigned(bytes.size());
    image->pcData = new aiTexel[bytes.size() / sizeof(aiTexel) + 1];  // the image owns it
    std::memcpy(image->pcData, bytes.data(), bytes.size());
    images.push_back(std::move(image));
  }
  std::set<std::string> known_;
};

std::unique_ptr<aiMaterial> material_of(const FbxObject& source, Images& images) {
  auto material = std::make_unique<aiMaterial>();
  const aiString name(source.name);
  material->AddProperty(&name, AI_MATKEY_NAME);
  add_color(color_of(source, "Diffuse"), AI_MATKEY_COLOR_DIFFUSE, *material);
  add_color(color_of(source, "Emissive"), AI_MATKEY_COLOR_EMISSIVE, *material);
  for (const char* base : kBaseColors)
    if (has(source, base)) add_color(source.vector(base, {}), AI_MATKEY_BASE_COLOR, *material);
  const int model = lowercase(std::string((*source.record)["ShadingModel"].text())) == "phong" ? aiShadingMode_Phong
                                                                                               : aiShadingMode_Gouraud;
  material->AddProperty(&model, 1, AI_MATKEY_SHADING_MODEL);
  FbxObject own = source;
  own.defaults = nullptr;  // programs write templates with highlights that their materials do not have
  add_color(color_of(own, "Specular"), AI_MATKEY_COLOR_SPECULAR, *material);
  const char* const shininess = has(source, "ShininessExponent") ? "ShininessExponent" : "Shininess";
  if (has(source, shininess)) add_number(source.number(shininess, 0.0), AI_MATKEY_SHININESS, *material);
  const glm::dvec3 clear = source.vector("TransparentColor", {}) * source.number("TransparencyFactor", 1.0);
  add_number(source.number("Opacity", 1.0 - (clear.x + clear.y + clear.z) / 3.0), AI_MATKEY_OPACITY, *material);
  for (const FbxObject::Link& link : source.children)
    for (const TexturedProperty& each : kTextured) {
      if (link.property != each.name) continue;
      const std::vector<FbxObject*> layers = link.object->parts("Texture");
      const FbxObject& texture = link.object->type == "LayeredTexture" && !layers.empty() ? *layers[0] : *link.object;
      const aiString path(images.name_of(texture));
      if (path.length > 0) material->AddProperty(&path, AI_MATKEY_TEXTURE(each.type, 0));
    }
  return material;
}

template <class T>
T** owned_list(std::vector<std::unique_ptr<T>>& from) {
  T** const list = new T*[from.size() + 1];
  for (std::size_t i = 0; i < from.size(); ++i) list[i] = from[i].release();
  return list;
}

}  // namespace

std::map<const FbxObject*, int> add_fbx_materials(const FbxFile& file, const std::filesystem::path& path,
                                                  Scene& scene) {
  std::map<const FbxObject*, int> index_of;
  std::vector<std::unique_ptr<aiMaterial>> materials;
  Images images;
  for (const auto& [number, object] : file.objects) {
    if (object.type != "Material") continue;
    index_of[&object] = int(scene.materials.size() + materials.size());
    materials.push_back(material_of(object, images));
  }
  aiScene source;  // owns the lists
  source.mNumMaterials = unsigned(materials.size());
  source.mMaterials = owned_list(materials);
  source.mNumTextures = unsigned(images.images.size());
  source.mTextures = owned_list(images.images);
  import_materials(source, path, "fbx", scene);
  return index_of;
}

}  // namespace umbrage
