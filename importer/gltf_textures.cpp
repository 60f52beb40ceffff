#include "importer/gltf_textures.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <glm/common.hpp>

#include "core/color.h"

namespace umbrage {
namespace {

/// Extensions of textures: their images are in another format.
struct TextureExtension {
  const char* name;
  bool is_read;
};
constexpr TextureExtension kExtensions[] = {{"EXT_texture_webp", true},
                                            {"KHR_texture_basisu", false},
                                            {"EXT_texture_avif", false},
                                            {"MSFT_texture_dds", false}};

constexpr const char* kImage = "\nimage ";

std::string title_of(const GltfFile& file, int image) {
  const Json& json = file.list("images", std::size_t(image));
  std::string name = text_of(member(json, "name"));
  if (name.empty()) name = text_of(member(json, "uri"));
  return name.empty() || name.starts_with("data:") ? fmt::format("image {}", image) : name;
}

const std::uint8_t* texel_of(const Texture& texture, int x, int y, int width, int height) {
  const std::size_t from_x = std::size_t(x) * std::size_t(texture.width) / std::size_t(width),
                    from_y = std::size_t(y) * std::size_t(texture.height) / std::size_t(height);
  return &texture.rgba[4 * (from_y * std::size_t(texture.width) + from_x)];
}

std::uint8_t byte_of(float fraction) { return std::uint8_t(std::clamp(fraction, 0.0f, 1.0f) * 255.0f + 0.5f); }

float brightness(const glm::vec3& c) { return std::sqrt(0.299f * c.x * c.x + 0.587f * c.y * c.y + 0.114f * c.z * c.z); }
float max_of(const glm::vec3& c) { return std::max({c.x, c.y, c.z}); }

struct BaseColor {
  glm::vec3 color;
  float metallic;
};

/// Returns the base colour and the metalness of a diffuse and a specular colour, which are linear.
BaseColor base_color_of(const glm::vec3& diffuse, const glm::vec3& specular) {
  constexpr float kDielectric = 0.04f, kTiny = 1e-6f;
  const float left = 1.0f - max_of(specular), d = brightness(diffuse), s = brightness(specular);
  float metallic = 0.0f;
  if (s >= kDielectric) {
    const float b = d * left / (1.0f - kDielectric) + s - 2.0f * kDielectric, c = kDielectric - s;
    metallic =
        std::clamp((-b + std::sqrt(std::max(b * b - 4.0f * kDielectric * c, 0.0f))) / (2.0f * kDielectric), 0.0f, 1.0f);
  }
  const glm::vec3 of_diffuse = diffuse * (left / (1.0f - kDielectric) / std::max(1.0f - metallic, kTiny)),
                  of_specular = (specular - kDielectric * (1.0f - metallic)) / std::max(metallic, kTiny);
  return {glm::clamp(glm::mix(of_diffuse, of_specular, metallic * metallic), 0.0f, 1.0f), metallic};
}

/// Linear values of sRGB bytes.
const std::array<float, 256>& linear_table() {
  static const auto table = [] {
    std::array<float, 256> values{};
    for (int v = 0; v < 256; ++v) values[std::size_t(v)] = linear_from_srgb(float(v) / 255.0f);
    return values;
  }();
  return table;
}

glm::vec3 linear_of(const std::uint8_t* texel) {
  const auto& table = linear_table();
  return {table[texel[0]], table[texel[1]], table[texel[2]]};
}

}  // namespace

GltfTextures::GltfTextures(GltfFile& file, Scene& scene)
    : cache{nullptr, file.path.parent_path(), scene}, file_(file), scene_(scene) {
  cache.read_embedded = [this](const std::string& name) -> std::optional<Result<EncodedImage>> {
    if (!name.starts_with('\n')) return std::nullopt;
    return embedded(name);
  };
}

std::string GltfTextures::name_of(const Json& use, const JsonPlace& place) {
  if (!use.is_object()) return "";
  const int index = index_of(member(use, "index"));
  const Json& texture = file_.list("textures", std::size_t(index));
  if (index < 0 || !texture.is_object()) {
    file_.faults.add(place, "texture");
    return "";
  }
  constexpr std::int64_t kRepeat = 10497;
  const Json& sampler = file_.list("samplers", std::size_t(index_of(member(texture, "sampler"))));
  for (const char* wrap : {"wrapS", "wrapT"})
    if (const Json& mode = member(sampler, wrap); !mode.is_null() && integer_of(mode) != kRepeat) has_borders = true;
  int image = index_of(member(texture, "source"));
  std::string unread;
  for (const TextureExtension& each : kExtensions) {
    const Json& extension = extension_of(texture, each.name);
    const int source = index_of(member(extension, "source"));
    if (source < 0) continue;
    if (each.is_read) {
      image = source;
      unread.clear();
      break;
    }
    if (image >= 0) continue;
    unread =
        fmt::format("the texture '{}' is in a format of {}, which is not read", title_of(file_, source), each.name);
  }
  if (!unread.empty() && image < 0) {
    const std::string name = fmt::format("\ntexture {}", index);
    refused_[name] = unread;
    return name;
  }
  const Json& json = file_.list("images", std::size_t(image));
  if (image < 0 || !json.is_object()) {
    const std::string name = fmt::format("\ntexture {}", index);
    refused_[name] = fmt::format("the texture {} has no image", index);
    return name;
  }
  const std::string uri = text_of(member(json, "uri"));
  const std::string name = uri.empty() || uri.starts_with("data:") ? kImage + std::to_string(image) : uri;
  constexpr std::int64_t kNearest = 9728;
  if (const Json& filter = member(sampler, "magFilter"); !filter.is_null() && integer_of(filter) == kNearest)
    cache.nearest.insert(name);
  return name;
}

Result<EncodedImage> GltfTextures::embedded(const std::string& name) {
  if (const auto reason = refused_.find(name); reason != refused_.end()) return file_error("{}", reason->second);
  const std::size_t skip = std::string_view(kImage).size();
  int image = 0;
  std::from_chars(name.data() + std::min(skip, name.size()), name.data() + name.size(), image);
  const Json& json = file_.list("images", std::size_t(image));
  const std::string title = "the embedded texture " + title_of(file_, image);
  if (auto data = data_of_uri(text_of(member(json, "uri")))) {
    if (!*data) return file_error("{} cannot be read: {}", title, data->error().message);
    return EncodedImage{.title = title, .owned = {(*data)->begin(), (*data)->end()}};
  }
  const auto bytes = file_.buffer_view(index_of(member(json, "bufferView")));
  if (!bytes) return file_error("{} cannot be read: {}", title, bytes.error().message);
  return EncodedImage{.title = title, .part = *bytes};
}

int GltfTextures::add(Texture texture, const std::string& key) {
  scene_.textures.push_back(std::move(texture));
  return computed_[key] = int(scene_.textures.size()) - 1;
}

int GltfTextures::find_transmission(const std::string& color, const std::string& transmission, float factor,
                                    float min_alpha) {
  const std::string key = fmt::format("t\n{}\n{}\n{}", color, transmission, factor);
  if (const auto known = computed_.find(key); known != computed_.end()) return known->second;
  const int base = color.empty() ? kNoTexture : cache.find(color),
            map = transmission.empty() ? kNoTexture : cache.find(transmission);
  if (map == kNoTexture) return base;
  const Texture& mask = scene_.textures[std::size_t(map)];
  Texture result = base == kNoTexture ? mask : scene_.textures[std::size_t(base)];
  result.name += " with " + mask.name;
  for (int y = 0; y < result.height; ++y)
    for (int x = 0; x < result.width; ++x) {
      std::uint8_t* to = &result.rgba[4 * (std::size_t(y) * std::size_t(result.width) + std::size_t(x))];
      const float red = float(texel_of(mask, x, y, result.width, result.height)[0]) / 255.0f;
      const float alpha = base == kNoTexture ? 1.0f : float(to[3]) / 255.0f;
      if (base == kNoTexture) std::fill(to, to + 3, std::uint8_t(255));
      to[3] = byte_of(alpha * std::max(1.0f - factor * red, min_alpha));
    }
  return add(std::move(result), key);
}

GltfTextures::Converted GltfTextures::convert_specular(const std::string& diffuse, const glm::vec3& diffuse_factor,
                                                       const std::string& specular, const glm::vec3& specular_factor,
                                                       float glossiness) {
  Converted result;
  const int color = diffuse.empty() ? kNoTexture : cache.find(diffuse),
            gloss = specular.empty() ? kNoTexture : cache.find(specular);
  if (gloss == kNoTexture) {
    // Without a map of the specular colour, one metalness is right for all texels.
    const BaseColor base = base_color_of(diffuse_factor, specular_factor);
    result.texture = color;
    result.albedo = base.color;
    result.metallic = base.metallic;
    result.roughness = 1.0f - glossiness;
    return result;
  }
  const std::string key =
      fmt::format("s\n{}\n{}\n{} {} {} {} {} {} {}", diffuse, specular, diffuse_factor.x, diffuse_factor.y,
                  diffuse_factor.z, specular_factor.x, specular_factor.y, specular_factor.z, glossiness);
  result.roughness = result.metallic = 1.0f;
  if (const auto known = computed_.find(key); known != computed_.end()) {
    result.texture = known->second;
    result.surface_texture = known->second + 1;
    return result;
  }
  const Texture& second = scene_.textures[std::size_t(gloss)];
  Texture base = color == kNoTexture ? second : scene_.textures[std::size_t(color)], surface = second;
  base.width = surface.width = std::max(base.width, second.width);
  base.height = surface.height = std::max(base.height, second.height);
  const std::size_t bytes = 4 * std::size_t(base.width) * std::size_t(base.height);
  base.rgba.assign(bytes, 255);
  surface.rgba.assign(bytes, 255);
  surface.linear = true;
  for (int y = 0; y < base.height; ++y)
    for (int x = 0; x < base.width; ++x) {
      const std::size_t at = 4 * (std::size_t(y) * std::size_t(base.width) + std::size_t(x));
      const std::uint8_t* s = texel_of(second, x, y, base.width, base.height);
      glm::vec3 diffuse_color = diffuse_factor;
      if (color != kNoTexture) {
        const std::uint8_t* d = texel_of(scene_.textures[std::size_t(color)], x, y, base.width, base.height);
        diffuse_color *= linear_of(d);
        base.rgba[at + 3] = d[3];
      }
      const BaseColor converted = base_color_of(diffuse_color, specular_factor * linear_of(s));
      for (int c = 0; c < 3; ++c) base.rgba[at + std::size_t(c)] = byte_of(srgb_from_linear(converted.color[c]));
      surface.rgba[at + 1] = byte_of(1.0f - glossiness * float(s[3]) / 255.0f);
      surface.rgba[at + 2] = byte_of(converted.metallic);
    }
  result.texture = add(std::move(base), key);
  scene_.textures.push_back(std::move(surface));
  result.surface_texture = result.texture + 1;
  return result;
}

}  // namespace umbrage
