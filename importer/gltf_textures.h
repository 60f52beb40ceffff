// Textures of glTF files: names for TextureCache, and textures computed from others.
#pragma once
#include <map>
#include <string>

#include "importer/gltf_file.h"
#include "importer/texture_cache.h"

namespace umbrage {

/// Finds the textures of a file. Textures are named by their files, or by "\n" and a number if they are in the file
/// itself or cannot be read.
class GltfTextures {
 public:
  GltfTextures(GltfFile& file, Scene& scene);

  TextureCache cache;
  bool has_borders = false;  ///< whether name_of has found a texture that does not repeat; the caller resets it

  /// Returns the name for `cache` of the texture that `use` ("baseColorTexture") refers to; empty if there is none.
  std::string name_of(const Json& use, const JsonPlace& place);

  /// Returns the index of a texture with the colour of `color` and the alpha 1 - factor * red of `transmission`, times
  /// that of `color`, but at least `min_alpha`. Either name may be empty. kNoTexture if none can be read.
  int find_transmission(const std::string& color, const std::string& transmission, float factor, float min_alpha);

  /// Metalness and roughness of a material of specular reflectance and glossiness.
  struct Converted {
    int texture = kNoTexture, surface_texture = kNoTexture;
    glm::vec3 albedo{1.0f};
    float metallic = 0.0f, roughness = 1.0f;
  };
  /// Converts diffuse and specular colour and glossiness, texel by texel [KHR_materials_pbrSpecularGlossiness,
  /// appendix B]. Either name may be empty.
  Converted convert_specular(const std::string& diffuse, const glm::vec3& diffuse_factor, const std::string& specular,
                             const glm::vec3& specular_factor, float glossiness);

 private:
  Result<EncodedImage> embedded(const std::string& name);
  int add(Texture texture, const std::string& key);

  GltfFile& file_;
  Scene& scene_;
  std::map<std::string, int> computed_;
  std::map<std::string, std::string> refused_;  ///< names of textures that cannot be read, and the reasons
};

}  // namespace umbrage
