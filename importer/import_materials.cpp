// Import of materials. Metalness and roughness become a Blinn-Phong highlight: exponent 2 / roughness^4 - 2, peak F0 *
// exponent / 8 [Karis 2013, "Specular BRDF Reference"].
#include "importer/import_materials.h"

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <map>
#include <optional>
#include <system_error>

#include "core/srgb.h"
#include "importer/material_rules.h"
#include "importer/texture_cache.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

constexpr glm::vec3 kNeutral{0.8f};      ///< surfaces without a colour in the file
constexpr float kMinExponent = 1.0f;     ///< with less, a highlight is as wide as the diffuse lobe
constexpr float kMaxExponent = 2048.0f;  ///< with more, a highlight is smaller than a pixel
constexpr float kDielectricReflectance = 0.04f;

float linear_of_srgb(float x) { return linear_from_srgb(std::clamp(x, 0.0f, 1.0f)); }

float clamp_to_unit(float x) { return x >= 0.0f ? std::min(x, 1.0f) : 0.0f; }
glm::vec3 clamp_to_unit(const glm::vec3& c) { return {clamp_to_unit(c.x), clamp_to_unit(c.y), clamp_to_unit(c.z)}; }

std::optional<glm::vec3> color_of(const aiMaterial& source, const char* key, unsigned type, unsigned index) {
  aiColor4D color;
  if (source.Get(key, type, index, color) != AI_SUCCESS) return std::nullopt;
  return glm::vec3(color.r, color.g, color.b);
}

std::optional<float> number_of(const aiMaterial& source, const char* key, unsigned type, unsigned index) {
  float value = 0.0f;
  if (source.Get(key, type, index, value) != AI_SUCCESS || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string texture_path(const aiMaterial& source, aiTextureType type) {
  aiString path;
  if (source.GetTexture(type, 0, &path) != AI_SUCCESS) return {};
  return path.C_Str();
}

bool has_clear_texels(const Texture& texture) {
  constexpr std::uint8_t kHalf = 128;
  for (std::size_t i = 3; i < texture.rgba.size(); i += 4) {
    if (texture.rgba[i] < kHalf) return true;
  }
  return false;
}

void set_highlight_of_roughness(const aiMaterial& source, Material& material) {
  const std::optional<float> metalness = number_of(source, AI_MATKEY_METALLIC_FACTOR),
                             roughness = number_of(source, AI_MATKEY_ROUGHNESS_FACTOR);
  if (!metalness && !roughness) return;
  // Roughness maps are not read, and the factors have no meaning without their maps. On average a matte surface is
  // right.
  if (!texture_path(source, aiTextureType_DIFFUSE_ROUGHNESS).empty() ||
      !texture_path(source, aiTextureType_METALNESS).empty() || !texture_path(source, aiTextureType_UNKNOWN).empty()) {
    return;
  }
  const float rough = std::max(clamp_to_unit(roughness.value_or(1.0f)), 0.01f);
  const float brightest = std::max({material.albedo.x, material.albedo.y, material.albedo.z});
  const float reflectance = glm::mix(kDielectricReflectance, brightest, clamp_to_unit(metalness.value_or(1.0f)));
  const float exponent = std::clamp(2.0f / (rough * rough * rough * rough) - 2.0f, 0.0f, kMaxExponent);
  constexpr float kPeakPerExponent = 1.0f / 8.0f;
  material.specular_strength = clamp_to_unit(reflectance * exponent * kPeakPerExponent);
  material.specular_exponent = std::max(exponent, kMinExponent);
}

void set_highlight(const aiMaterial& source, Material& material) {
  int model = aiShadingMode_Phong;
  source.Get(AI_MATKEY_SHADING_MODEL, model);
  if (model == aiShadingMode_NoShading || model == aiShadingMode_Flat || model == aiShadingMode_Gouraud) return;
  const std::optional<glm::vec3> specular = color_of(source, AI_MATKEY_COLOR_SPECULAR);
  const std::optional<float> exponent = number_of(source, AI_MATKEY_SHININESS);
  if (!specular || !exponent || *exponent <= 0.0f) return;
  const float fraction = number_of(source, AI_MATKEY_SHININESS_STRENGTH).value_or(1.0f);
  material.specular_strength = clamp_to_unit(std::max({specular->x, specular->y, specular->z}) * fraction);
  material.specular_exponent = std::clamp(*exponent, kMinExponent, kMaxExponent);
}

/// Sets the opacity. Some exporters write 0 where they mean that nothing is transparent.
void set_opacity(const aiMaterial& source, Material& material) {
  const float opacity = number_of(source, AI_MATKEY_OPACITY).value_or(1.0f);
  if (!(opacity >= kMinOpacity && opacity < kOpaque)) return;
  material.blended = true;
  material.opacity = opacity;
}

/// Sets the emission. Emission textures are used only for glTF.
void set_emission(const aiMaterial& source, const GltfMaterial* gltf, TextureCache& textures, Material& material) {
  const std::string map = texture_path(source, aiTextureType_EMISSIVE);
  const auto emission = color_of(source, AI_MATKEY_COLOR_EMISSIVE);
  if (!emission || (!map.empty() && !gltf)) return;
  const float strength =
      gltf ? gltf->emission_strength : number_of(source, AI_MATKEY_EMISSIVE_INTENSITY).value_or(1.0f);
  for (int i = 0; i < 3; ++i) {
    const float channel = (*emission)[i] * strength;
    material.emission[i] = channel > 0.0f && std::isfinite(channel) ? channel : 0.0f;
  }
  if (map.empty() || material.emission == glm::vec3(0.0f)) return;
  material.emission_texture = textures.find(map, "its surfaces do not glow");
  if (material.emission_texture == kNoTexture) material.emission = glm::vec3(0.0f);
}

/// Sets metalness, roughness and the maps of glTF. A map that is placed otherwise than the material's first one is left
/// out, since a mesh has one set of texture coordinates.
void set_maps_of_gltf(const aiMaterial& source, const GltfMaterial& gltf, TextureCache& textures, Material& material) {
  material.ignored = gltf.ignored;
  const auto path_of = [&](GltfMap map, aiTextureType type, const char* name) -> std::string {
    if (!gltf.maps[map]) return "";
    if (*gltf.maps[map] == gltf.placement()) return texture_path(source, type);
    material.ignored.push_back(fmt::format("{} with other texture coordinates", name));
    return "";
  };
  if (gltf.has_roughness) {
    material.metallic = gltf.metallic;
    material.roughness = gltf.roughness;
  }
  const std::string surface = path_of(kSurfaceMap, aiTextureType_UNKNOWN, "metallicRoughnessTexture"),
                    occlusion = path_of(kOcclusionMap, aiTextureType_LIGHTMAP, "occlusionTexture"),
                    normal = path_of(kNormalMap, aiTextureType_NORMALS, "normalTexture");
  if (!surface.empty() || !occlusion.empty())
    material.surface_texture = textures.find_packed({{{occlusion, 0}, {surface, 1}, {surface, 2}}});
  const bool read = material.surface_texture != kNoTexture && !surface.empty() && !textures.reported.contains(surface);
  if (!read && gltf.maps[kSurfaceMap]) {
    // Without their map the factors mean nothing.
    material.metallic = 0.0f;
    material.roughness = kNoRoughness;
  }
  if (!occlusion.empty()) material.occlusion_strength = gltf.occlusion_strength;
  if (!normal.empty()) material.normal_texture = textures.find_linear(normal);
  material.normal_scale = gltf.normal_scale;
}

Material material_of(const aiMaterial& source, const std::string& format, const GltfMaterial* gltf,
                     TextureCache& textures) {
  Material material;
  aiString name;
  if (source.Get(AI_MATKEY_NAME, name) == AI_SUCCESS) material.name = name.C_Str();
  const bool is_gltf = format == "gltf" || format == "glb", unlit = gltf && gltf->unlit;

  // STL, PLY and OFF files have no materials, and 3DS files may have none: then the material is Assimp's default.
  constexpr const char* kDefaultOf3ds = "%%%DEFAULT";
  const bool is_default = (material.name == AI_DEFAULT_MATERIAL_NAME && !is_gltf) || material.name == kDefaultOf3ds;
  std::optional<glm::vec3> color = color_of(source, AI_MATKEY_BASE_COLOR);
  if (!color) color = color_of(source, AI_MATKEY_COLOR_DIFFUSE);
  glm::vec3 albedo = color && !is_default ? clamp_to_unit(*color) : kNeutral;
  if (format == "3ds") albedo = {linear_of_srgb(albedo.x), linear_of_srgb(albedo.y), linear_of_srgb(albedo.z)};
  material.albedo = albedo;
  if (is_gltf) {
    if (!unlit) set_highlight_of_roughness(source, material);  // unlit materials are drawn matte
  } else if (!is_default) {
    set_highlight(source, material);
  }

  if (!is_gltf && !is_default) set_opacity(source, material);
  if (!is_default) set_emission(source, gltf, textures, material);
  if (gltf && !unlit) set_maps_of_gltf(source, *gltf, textures, material);

  std::string color_path = texture_path(source, aiTextureType_BASE_COLOR);
  if (color_path.empty()) color_path = texture_path(source, aiTextureType_DIFFUSE);
  const std::string mask = is_gltf ? "" : texture_path(source, aiTextureType_OPACITY);
  if (color_path.empty() && mask.empty()) return material;
  material.texture =
      mask.empty() || mask == color_path ? textures.find(color_path) : textures.find_with_mask(color_path, mask);
  if (material.texture == kNoTexture) {
    material.albedo = kNeutral;
    return material;
  }
  // Some exporters write a black colour with a texture, because the texture replaces the colour in their viewer.
  if (!is_gltf && albedo == glm::vec3(0.0f)) material.albedo = glm::vec3(1.0f);

  const Texture& texture = textures.scene.textures[std::size_t(material.texture)];
  aiString mode;
  const bool has_mode = source.Get(AI_MATKEY_GLTF_ALPHAMODE, mode) == AI_SUCCESS;
  if (has_mode && std::strcmp(mode.C_Str(), "MASK") == 0) {
    material.alpha_mask = true;
    material.alpha_cutoff = number_of(source, AI_MATKEY_GLTF_ALPHACUTOFF).value_or(0.5f);
    aiColor4D factor;
    if (source.Get(AI_MATKEY_BASE_COLOR, factor) == AI_SUCCESS && factor.a > 0.0f) material.alpha_cutoff /= factor.a;
  } else if (!has_mode || std::strcmp(mode.C_Str(), "OPAQUE") != 0) {
    // Blended surfaces are cut out instead: only their parts with an alpha of at least 0.5 are drawn.
    material.alpha_mask = is_cut_out(texture);
    if (!material.alpha_mask && has_mode && has_clear_texels(texture)) {
      const int blended = textures.find_blended(material.texture);
      material.alpha_mask = has_clear_texels(textures.scene.textures[std::size_t(blended)]);
      if (material.alpha_mask) material.texture = blended;
    }
  }
  return material;
}

}  // namespace

void import_materials(const aiScene& source, const fs::path& file, const std::string& format, const GltfFacts& gltf,
                      Scene& scene, std::vector<bool>& not_drawn) {
  TextureCache textures{&source, file.parent_path(), scene};
  for (unsigned i = 0; i < source.mNumMaterials; ++i) {
    const GltfMaterial* facts = i < gltf.materials.size() ? &gltf.materials[i] : nullptr;
    scene.materials.push_back(material_of(*source.mMaterials[i], format, facts, textures));
    constexpr float kHalf = 0.5f;
    const bool blended = facts && facts->mode == "BLEND" && facts->alpha < kHalf,
               masked = facts && facts->mode == "MASK" && facts->alpha < facts->cutoff;
    not_drawn.push_back(blended || masked);
  }
}

int import_texture(const fs::path& file, const std::string& name, Scene& scene) {
  TextureCache textures{nullptr, file.parent_path(), scene};
  return textures.find(name);
}

}  // namespace umbrage
