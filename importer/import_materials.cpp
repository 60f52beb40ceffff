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
#include "importer/limits.h"
#include "scene/readers/texture_file.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

constexpr glm::vec3 kNeutral{0.8f};      ///< surfaces without a colour in the file
constexpr float kMinExponent = 1.0f;     ///< with less, a highlight is as wide as the diffuse lobe
constexpr float kMaxExponent = 2048.0f;  ///< with more, a highlight is smaller than a pixel
constexpr float kDielectricReflectance = 0.04f;

/// A texture is a cut-out if at least kBinaryFraction of its texels are nearly transparent or nearly opaque, and at
/// least kClearFraction are nearly transparent.
constexpr double kBinaryFraction = 0.9, kClearFraction = 0.001;
// Width over which the alpha of a blended surface is averaged, as a fraction of its texture's width.
constexpr double kBlendFraction = 1.0 / 64.0;
constexpr std::uint8_t kNearlyClear = 16, kNearlyOpaque = 239;

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

std::string lower(std::string text) {
  for (char& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Replaces URI escapes such as "%20".
std::string without_escapes(const std::string& text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool escape = text[i] == '%' && i + 2 < text.size() &&
                        std::isxdigit(static_cast<unsigned char>(text[i + 1])) &&
                        std::isxdigit(static_cast<unsigned char>(text[i + 2]));
    plain += escape ? char(std::stoi(text.substr(i + 1, 2), nullptr, 16)) : text[i];
    if (escape) i += 2;
  }
  return plain;
}

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

/// Returns the file of this name in a folder; upper and lower case are equal.
std::optional<fs::path> find_in(const fs::path& folder, const std::string& name) {
  std::error_code error;
  const std::string lower_name = lower(name);
  for (fs::directory_iterator entry(folder.empty() ? fs::path(".") : folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (lower(entry->path().filename().string()) == lower_name && is_file(entry->path())) return entry->path();
  }
  return std::nullopt;
}

/// Searches for a texture at the path in the model, then for the same path ignoring case, then for the file name beside
/// the model: paths in model files are often valid only on the machine that wrote them.
std::optional<fs::path> find_texture(const fs::path& folder, std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  name.erase(name.find_last_not_of(" \t\r") + 1);
  // Assimp's parser includes MTL options in the name: "-colorspace sRGB wood.png".
  const std::string last_word = name.substr(name.find_last_of(' ') + 1);
  for (const std::string& spelling : {name, without_escapes(name), last_word}) {
    if (spelling.empty()) continue;
    const fs::path path(spelling), beside = folder / path;  // an absolute path replaces the folder
    if (is_file(beside)) return beside;
    if (auto found = find_in(beside.parent_path(), path.filename().string())) return found;
    if (auto found = find_in(folder, path.filename().string())) return found;
  }
  return std::nullopt;
}

/// Reads each texture of a model file once.
struct TextureCache {
  const aiScene* source;  // null for formats without embedded textures
  fs::path folder;
  Scene& scene;
  std::map<std::string, int> index_of;  // by the name in the file; kNoTexture if reading failed

  Result<Texture> embedded(const aiTexture& texture, const std::string& name) {
    if (!texture.pcData) return file_error("the embedded texture '{}' has no pixels", name);
    if (texture.mHeight == 0) {
      return decode_texture({reinterpret_cast<const std::uint8_t*>(texture.pcData), texture.mWidth},
                            "the embedded texture " + name);
    }
    Texture result;
    result.name = name;
    result.width = int(texture.mWidth);
    result.height = int(texture.mHeight);
    result.rgba.reserve(std::size_t(result.width) * result.height * 4);
    for (std::size_t i = 0; i < std::size_t(result.width) * result.height; ++i) {
      const aiTexel& texel = texture.pcData[i];
      result.rgba.insert(result.rgba.end(), {texel.r, texel.g, texel.b, texel.a});
    }
    return result;
  }

  Result<Texture> read(const std::string& name) {
    if (const aiTexture* texture = source ? source->GetEmbeddedTexture(name.c_str()) : nullptr) {
      return embedded(*texture, name);
    }
    const std::optional<fs::path> path = find_texture(folder, name);
    if (!path) return file_error("the texture '{}' does not exist", name);
    raise_limits_for(*path);
    return read_texture(*path);
  }

  /// Returns the index of a texture in the scene, or kNoTexture after adding a warning.
  int find(const std::string& name) {
    if (const auto known = index_of.find(name); known != index_of.end()) return known->second;
    Result<Texture> texture = read(name);
    int index = kNoTexture;
    if (texture) {
      index = int(scene.textures.size());
      scene.textures.push_back(std::move(*texture));
    } else {
      scene.warnings.push_back(texture.error().message + "; its surfaces are shown in a neutral colour");
    }
    index_of[name] = index;
    return index;
  }

  /// Returns the index of a texture that combines the colour of the first texture with the mask of the second as alpha.
  /// The mask is the alpha channel of the second texture if that is not 1 everywhere, else its brightness.
  int find_with_mask(const std::string& color_name, const std::string& mask_name) {
    const std::string key = color_name + '\n' + mask_name;
    if (const auto known = index_of.find(key); known != index_of.end()) return known->second;
    Result<Texture> mask = read(mask_name);
    if (!mask) {
      scene.warnings.push_back(mask.error().message + "; its surfaces are not cut out");
      return index_of[key] = color_name.empty() ? kNoTexture : find(color_name);
    }
    const int color = color_name.empty() ? kNoTexture : find(color_name);
    Texture result = *mask;
    bool has_alpha = false;
    for (std::size_t i = 3; i < mask->rgba.size() && !has_alpha; i += 4) has_alpha = mask->rgba[i] != 255;
    if (color != kNoTexture) {
      result = scene.textures[std::size_t(color)];
      result.name += " with the mask " + mask->name;
    }
    for (int y = 0; y < result.height; ++y) {
      for (int x = 0; x < result.width; ++x) {
        const std::size_t from_x = std::size_t(x) * mask->width / result.width,
                          from_y = std::size_t(y) * mask->height / result.height;
        const std::uint8_t* from = &mask->rgba[4 * (from_y * mask->width + from_x)];
        std::uint8_t* to = &result.rgba[4 * (std::size_t(y) * result.width + x)];
        to[3] = has_alpha ? from[3] : std::max({from[0], from[1], from[2]});
        if (color == kNoTexture) std::fill(to, to + 3, std::uint8_t(255));
      }
    }
    scene.textures.push_back(std::move(result));
    return index_of[key] = int(scene.textures.size()) - 1;
  }

  /// Returns the index of a copy of a texture whose alpha is averaged over kBlendFraction of its width. Then only
  /// regions that are mostly transparent are cut out, not each small spot, which would give speckled borders. Small
  /// textures, such as palettes, have no such spots and stay unchanged.
  int find_blended(int index) {
    const int radius = int(0.5 * kBlendFraction * scene.textures[std::size_t(index)].width);
    if (radius < 1) return index;
    const std::string key = scene.textures[std::size_t(index)].name + "\nblended";
    if (const auto known = index_of.find(key); known != index_of.end()) return known->second;
    Texture result = scene.textures[std::size_t(index)];
    const std::ptrdiff_t row = 4 * std::ptrdiff_t(result.width);
    average_alpha(result, result.width, result.height, 4, row, radius);
    average_alpha(result, result.height, result.width, row, 4, radius);
    scene.textures.push_back(std::move(result));
    return index_of[key] = int(scene.textures.size()) - 1;
  }

 private:
  /// Applies a box filter of 2 radius + 1 texels twice to the alpha of `lines` rows or columns of `length` texels each.
  /// The texture repeats. `step`: bytes from a texel to the next one in its line. `next`: bytes from a line to the
  /// next.
  static void average_alpha(Texture& texture, int length, int lines, std::ptrdiff_t step, std::ptrdiff_t next,
                            int radius) {
    constexpr int kRounds = 2;
    std::vector<int> line(static_cast<std::size_t>(length + 2 * radius + 1));  // from -radius to length + radius
    for (int k = 0; k < lines; ++k)
      for (int round = 0; round < kRounds; ++round) {
        std::uint8_t* alpha = texture.rgba.data() + k * next + 3;
        for (int i = 0; i < length; ++i) line[std::size_t(i + radius)] = alpha[i * step];
        for (int i = 0; i < radius; ++i) line[std::size_t(i)] = alpha[((i - radius) % length + length) % length * step];
        for (int i = 0; i <= radius; ++i) line[std::size_t(length + radius + i)] = alpha[i % length * step];
        int sum = 0;
        for (int i = 0; i <= 2 * radius; ++i) sum += line[std::size_t(i)];
        for (int i = 0; i < length; ++i) {
          alpha[i * step] = std::uint8_t((sum + radius) / (2 * radius + 1));
          sum += line[std::size_t(i + 2 * radius + 1)] - line[std::size_t(i)];
        }
      }
  }
};

bool is_cut_out(const Texture& texture) {
  std::size_t clear = 0, opaque = 0;
  for (std::size_t i = 3; i < texture.rgba.size(); i += 4) {
    clear += texture.rgba[i] < kNearlyClear;
    opaque += texture.rgba[i] > kNearlyOpaque;
  }
  const double count = double(texture.rgba.size() / 4);
  return double(clear + opaque) >= kBinaryFraction * count && double(clear) >= kClearFraction * count;
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
  material.emission_texture = textures.find(map);
  if (material.emission_texture == kNoTexture) material.emission = glm::vec3(0.0f);
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

  if (!is_default) set_emission(source, gltf, textures, material);

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
  TextureCache textures{&source, file.parent_path(), scene, {}};
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
  TextureCache textures{nullptr, file.parent_path(), scene, {}};
  return textures.find(name);
}

}  // namespace umbrage
