// Import of materials of formats that Assimp reads.
#include "importer/import_materials.h"

#include <assimp/material.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/color.h"
#include "importer/material_rules.h"
#include "importer/texture_cache.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

constexpr glm::vec3 kNeutral{0.8f};  ///< surfaces without a colour in the file

float linear_of_srgb(float x) { return linear_from_srgb(std::clamp(x, 0.0f, 1.0f)); }

float clamp_to_unit(float x) { return x >= 0.0f ? std::min(x, 1.0f) : 0.0f; }
glm::vec3 clamp_to_unit(const glm::vec3& c) { return {clamp_to_unit(c.x), clamp_to_unit(c.y), clamp_to_unit(c.z)}; }

std::optional<glm::vec3> color_of(const aiMaterial& source, const char* key, unsigned type, unsigned index) {
  aiColor4D color;
  if (source.Get(key, type, index, color) != AI_SUCCESS) return std::nullopt;
  return glm::vec3(color.r, color.g, color.b);
}

std::optional<float> property_number(const aiMaterial& source, const char* key, unsigned type, unsigned index) {
  float value = 0.0f;
  if (source.Get(key, type, index, value) != AI_SUCCESS || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string texture_path(const aiMaterial& source, aiTextureType type) {
  aiString path;
  if (source.GetTexture(type, 0, &path) != AI_SUCCESS) return {};
  return path.C_Str();
}

void set_highlight(const aiMaterial& source, Material& material) {
  int model = aiShadingMode_Phong;
  source.Get(AI_MATKEY_SHADING_MODEL, model);
  if (model == aiShadingMode_NoShading || model == aiShadingMode_Flat || model == aiShadingMode_Gouraud) return;
  const std::optional<glm::vec3> specular = color_of(source, AI_MATKEY_COLOR_SPECULAR);
  const std::optional<float> exponent = property_number(source, AI_MATKEY_SHININESS);
  if (!specular || !exponent || *exponent <= 0.0f) return;
  const float fraction = property_number(source, AI_MATKEY_SHININESS_STRENGTH).value_or(1.0f);
  material.specular_strength = clamp_to_unit(std::max({specular->x, specular->y, specular->z}) * fraction);
  material.specular_exponent = std::clamp(*exponent, kMinExponent, kMaxExponent);
}

/// Sets the opacity. Some exporters write 0 where they mean that nothing is transparent.
void set_opacity(const aiMaterial& source, Material& material) {
  const float opacity = property_number(source, AI_MATKEY_OPACITY).value_or(1.0f);
  if (!(opacity >= kMinOpacity && opacity < kOpaque)) return;
  material.blended = true;
  material.opacity = opacity;
}

/// Sets the emission, unless it has a texture.
void set_emission(const aiMaterial& source, Material& material) {
  const auto emission = color_of(source, AI_MATKEY_COLOR_EMISSIVE);
  if (!emission || !texture_path(source, aiTextureType_EMISSIVE).empty()) return;
  const float strength = property_number(source, AI_MATKEY_EMISSIVE_INTENSITY).value_or(1.0f);
  for (int i = 0; i < 3; ++i) {
    const float channel = (*emission)[i] * strength;
    material.emission[i] = channel > 0.0f && std::isfinite(channel) ? channel : 0.0f;
  }
}

Material material_of(const aiMaterial& source, const std::string& format, TextureCache& textures) {
  Material material;
  aiString name;
  if (source.Get(AI_MATKEY_NAME, name) == AI_SUCCESS) material.name = name.C_Str();

  // Files may have no materials: then the material is Assimp's default.
  constexpr const char* kDefaultOf3ds = "%%%DEFAULT";
  const bool is_default = material.name == AI_DEFAULT_MATERIAL_NAME || material.name == kDefaultOf3ds;
  std::optional<glm::vec3> color = color_of(source, AI_MATKEY_BASE_COLOR);
  if (!color) color = color_of(source, AI_MATKEY_COLOR_DIFFUSE);
  glm::vec3 albedo = color && !is_default ? clamp_to_unit(*color) : kNeutral;
  if (format == "3ds") albedo = {linear_of_srgb(albedo.x), linear_of_srgb(albedo.y), linear_of_srgb(albedo.z)};
  material.albedo = albedo;
  if (!is_default) {
    set_highlight(source, material);
    set_opacity(source, material);
    set_emission(source, material);
  }

  std::string color_path = texture_path(source, aiTextureType_BASE_COLOR);
  if (color_path.empty()) color_path = texture_path(source, aiTextureType_DIFFUSE);
  const std::string mask = texture_path(source, aiTextureType_OPACITY);
  if (color_path.empty() && mask.empty()) return material;
  material.texture =
      mask.empty() || mask == color_path ? textures.find(color_path) : textures.find_with_mask(color_path, mask);
  if (material.texture == kNoTexture) {
    material.albedo = kNeutral;
    return material;
  }
  // Some exporters write a black colour with a texture, because the texture replaces the colour in their viewer.
  if (albedo == glm::vec3(0.0f)) material.albedo = glm::vec3(1.0f);
  material.alpha_mask = is_cut_out(textures.scene.textures[std::size_t(material.texture)]);
  return material;
}

}  // namespace

void import_materials(const aiScene& source, const fs::path& file, const std::string& format, Scene& scene) {
  TextureCache textures{&source, file.parent_path(), scene};
  for (unsigned i = 0; i < source.mNumMaterials; ++i)
    scene.materials.push_back(material_of(*source.mMaterials[i], format, textures));
}

int import_texture(const fs::path& file, const std::string& name, Scene& scene) {
  TextureCache textures{nullptr, file.parent_path(), scene};
  return textures.find(name);
}

}  // namespace umbrage
