// The textures of a model file: finds and reads each of them once, and combines them.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>

#include "core/result.h"
#include "importer/decode_image.h"
#include "scene/scene.h"

struct aiScene;
struct aiTexture;

namespace umbrage {

/// Replaces URI escapes such as "%20".
std::string without_escapes(const std::string& text);

/// Searches for a file as find_file does, also without URI escapes.
std::optional<std::filesystem::path> find_referenced_file(const std::filesystem::path& folder, const std::string& name);

/// One channel of an image file, 0 to 3. An empty name: white.
struct MapChannel {
  std::string name;
  int channel = 0;
};

/// An image with changed texels: the channel r, g, b, m (alpha) or l (luminance) in place of the colours, unless it is
/// '\0', then base + gain * value of values from 0 to 1.
struct ImageEdit {
  std::string file;
  char channel = '\0';
  float base = 0.0f, gain = 1.0f;
};

/// The bytes of an image.
struct EncodedImage {
  std::string title = {};                   ///< for messages
  std::string owned = {};                   ///< empty: the bytes are `part`
  std::span<const std::uint8_t> part = {};  ///< of the model's file

  std::span<const std::uint8_t> bytes() const {
    return owned.empty() ? part : std::span(reinterpret_cast<const std::uint8_t*>(owned.data()), owned.size());
  }
};

/// Names of images, and what they are decoded for.
using ImageUses = std::map<std::string, ImageUse>;

/// Adds textures to a scene. All functions return the index of a texture in the scene, or kNoTexture after adding one
/// warning per missing or unreadable file.
struct TextureCache {
  const aiScene* source;  // null for formats without embedded textures
  std::filesystem::path folder;
  Scene& scene;
  std::map<std::string, int> index_of = {};     // by the name in the file; kNoTexture if reading failed
  std::set<std::string> reported = {};          // files with a warning
  std::map<std::string, ImageEdit> edits = {};  // names that stand for an image with changed texels
  std::set<std::string> nearest = {};           // names of textures whose texels have sharp edges
  /// Returns an image that is not in a file of its own; nothing if it is. May be empty.
  std::function<std::optional<Result<EncodedImage>>(const std::string& name)> read_embedded = {};
  /// Not null: no image is read; each is a white texel, and is added here.
  ImageUses* asked = nullptr;
  ImageUses uses = {};                                  // of the images that are decoded in parallel
  std::map<std::string, Result<Texture>> decoded = {};  // those of them that nothing has asked for so far

  /// Decodes images in parallel, before the functions below ask for them, which report errors.
  void decode(const ImageUses& images);

  /// Finds a texture of colours. `consequence`: the end of the warning if it cannot be read.
  int find(const std::string& name, const char* consequence = "its surfaces are shown in a neutral colour");
  /// Finds a texture of linear values.
  int find_linear(const std::string& name);
  /// Finds a texture that combines the colour of the first texture with the mask of the second as alpha. The mask is
  /// the alpha channel of the second texture if that is not 1 everywhere, else its brightness.
  int find_with_mask(const std::string& color_name, const std::string& mask_name);
  /// Finds a linear texture with these channels as red, green and blue, as large as the largest of their images. Files
  /// that cannot be read count as white; kNoTexture if none can.
  int find_packed(const std::array<MapChannel, 3>& channels);
  /// Finds a linear texture with the normals of a height map: of the first channel, whose whole range is `scale` times
  /// the distance of two texels high.
  int find_normals_of_heights(const std::string& name, float scale);

 private:
  Result<Texture> embedded(const aiTexture& texture, const std::string& name) const;
  Result<EncodedImage> encoded(const std::string& name) const;
  Result<Texture> read(const std::string& name);
  /// Reads a texture, or adds a warning, which ends with `consequence`, unless the file has one. `linear`: see
  /// ImageUse.
  std::optional<Texture> read_or_warn(const std::string& name, const char* consequence, bool linear = false);
  int add(Texture texture, const std::string& key);
};

}  // namespace umbrage
