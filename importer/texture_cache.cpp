#include "importer/texture_cache.h"

#include <assimp/scene.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstring>
#include <glm/geometric.hpp>

#include "importer/importer.h"
#include "importer/material_rules.h"
#include "scene/readers/find_file.h"
#include "scene/readers/whole_file.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

/// Applies an ImageEdit to a texture.
void edit_image(const ImageEdit& edit, Texture& texture) {
  std::array<std::uint8_t, 256> changed;
  for (int k = 0; k < 256; ++k)
    changed[std::size_t(k)] =
        std::uint8_t(std::clamp(edit.base + edit.gain * (float(k) / 255.0f), 0.0f, 1.0f) * 255.0f + 0.5f);
  for (std::size_t i = 0; i + 3 < texture.rgba.size(); i += 4) {
    std::uint8_t* texel = &texture.rgba[i];
    if (edit.channel != '\0') {
      constexpr std::string_view kChannels = "rgbm";
      const auto channel = kChannels.find(edit.channel);
      const float luminance = 0.2126f * texel[0] + 0.7152f * texel[1] + 0.0722f * texel[2];
      const std::uint8_t value = channel < kChannels.size() ? texel[channel] : std::uint8_t(luminance + 0.5f);
      std::fill(texel, texel + 3, value);
      texel[3] = 255;
    }
    for (int c = 0; c < 3; ++c) texel[c] = changed[texel[c]];
  }
}

}  // namespace

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

std::optional<fs::path> find_referenced_file(const fs::path& folder, const std::string& name) {
  if (auto found = find_file(folder, name)) return found;
  return find_file(folder, without_escapes(name));
}

Result<EncodedImage> TextureCache::encoded(const std::string& name) const {
  if (read_embedded)
    if (auto image = read_embedded(name)) return std::move(*image);
  const std::optional<fs::path> path = find_referenced_file(folder, name);
  if (!path) return file_error("the texture '{}' does not exist", name);
  raise_limits_for(*path);
  auto bytes = read_whole_file(*path);
  if (!bytes) return bytes.error();
  return EncodedImage{.title = path->string(), .owned = std::move(*bytes)};
}

Result<Texture> TextureCache::embedded(const aiTexture& texture, const std::string& name) const {
  if (!texture.pcData) return file_error("the embedded texture '{}' has no pixels", name);
  if (texture.mHeight == 0) {
    return decode_texture_image({reinterpret_cast<const std::uint8_t*>(texture.pcData), texture.mWidth},
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

void TextureCache::decode(const ImageUses& images) {
  constexpr int kMaxThreads = 8;  // their stacks count towards the limit of address space
  struct Job {
    Result<EncodedImage> image;
    const ImageUse& use;
    Result<Texture>& texture;
  };
  uses = images;
  std::vector<Job> jobs;
  for (const auto& [name, use] : uses)
    jobs.push_back({encoded(name), use, decoded.insert_or_assign(name, Texture()).first->second});
  tbb::task_arena arena(std::min(tbb::this_task_arena::max_concurrency(), kMaxThreads));
  arena.execute([&] {
    tbb::parallel_for(
        std::size_t(0), jobs.size(),
        [&](std::size_t k) {
          Job& job = jobs[k];
          try {
            job.texture = job.image ? decode_texture_image(job.image->bytes(), job.image->title, job.use)
                                    : Result<Texture>(job.image.error());
          } catch (const std::bad_alloc&) {
            job.texture = file_error("'{}' is too large", job.image->title);
          }
          job.image = EncodedImage();
        },
        tbb::simple_partitioner());
  });
  // One that failed is read again when it is asked for: alone it may find the memory that it lacked.
  std::erase_if(decoded, [](const auto& each) { return !each.second; });
}

Result<Texture> TextureCache::read(const std::string& name) {
  if (const auto edit = edits.find(name); edit != edits.end()) {
    Result<Texture> texture = read(edit->second.file);
    if (texture) edit_image(edit->second, *texture);
    return texture;
  }
  if (auto known = decoded.extract(name)) return std::move(known.mapped());
  if (const aiTexture* texture = source ? source->GetEmbeddedTexture(name.c_str()) : nullptr) {
    return embedded(*texture, name);
  }
  const auto image = encoded(name);
  if (!image) return image.error();
  const auto use = uses.find(name);
  return decode_texture_image(image->bytes(), image->title, use == uses.end() ? ImageUse() : use->second);
}

std::optional<Texture> TextureCache::read_or_warn(const std::string& name, const char* consequence, bool linear) {
  if (asked) {
    const auto edit = edits.find(name);
    const auto [use, is_new] = asked->insert({edit == edits.end() ? name : edit->second.file, {.linear = linear}});
    use->second.linear = use->second.linear && linear;
    return Texture{.name = {}, .width = 1, .height = 1, .rgba = {255, 255, 255, 255}};
  }
  Result<Texture> texture = read(name);
  if (texture) texture->nearest = nearest.contains(name);
  if (texture) return std::move(*texture);
  if (reported.insert(name).second) scene.warnings.push_back(texture.error().message + "; " + consequence);
  return std::nullopt;
}

int TextureCache::add(Texture texture, const std::string& key) {
  scene.textures.push_back(std::move(texture));
  return index_of[key] = int(scene.textures.size()) - 1;
}

int TextureCache::find(const std::string& name, const char* consequence) {
  if (const auto known = index_of.find(name); known != index_of.end()) return known->second;
  std::optional<Texture> texture = read_or_warn(name, consequence);
  return texture ? add(std::move(*texture), name) : index_of[name] = kNoTexture;
}

int TextureCache::find_with_mask(const std::string& color_name, const std::string& mask_name) {
  const std::string key = color_name + '\n' + mask_name;
  if (const auto known = index_of.find(key); known != index_of.end()) return known->second;
  const std::optional<Texture> mask = read_or_warn(mask_name, "its surfaces are not cut out");
  if (!mask) return index_of[key] = color_name.empty() ? kNoTexture : find(color_name);
  const int color = color_name.empty() ? kNoTexture : find(color_name);
  Texture result = *mask;
  const bool has_alpha = has_transparent_texels(*mask);
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
  return add(std::move(result), key);
}

int TextureCache::find_packed(const std::array<MapChannel, 3>& channels) {
  std::string key = "\npacked";
  for (const MapChannel& each : channels) key += fmt::format("\n{} {}", each.channel, each.name);
  if (const auto known = index_of.find(key); known != index_of.end()) return known->second;
  const auto is_in_place = [&](const MapChannel& each) {
    return each.name.empty() || each.channel == int(&each - channels.data());
  };
  std::map<std::string, std::optional<Texture>> images;
  Texture result{.name = {}, .rgba = {}, .linear = true};
  for (const MapChannel& each : channels) {
    if (each.name.empty() || images.contains(each.name)) continue;
    const auto& image = images[each.name] = read_or_warn(each.name, "it is left out", true);
    if (!image) continue;
    result.nearest = result.nearest || image->nearest;
    result.name += (result.name.empty() ? "" : " and ") + image->name;
    result.width = std::max(result.width, image->width);
    result.height = std::max(result.height, image->height);
  }
  if (result.width == 0) return index_of[key] = kNoTexture;
  if (images.size() == 1 && std::all_of(channels.begin(), channels.end(), is_in_place)) {
    // All channels stay where they are in one image.
    result.rgba = std::move(images.begin()->second->rgba);
    std::array<std::uint8_t, 4> white{0, 0, 0, 255};
    for (std::size_t c = 0; c < channels.size(); ++c) white[c] = channels[c].name.empty() ? 255 : 0;
    const auto added = std::bit_cast<std::uint32_t>(white);
    for (std::uint8_t *texel = result.rgba.data(), *end = texel + result.rgba.size(); texel != end; texel += 4) {
      std::uint32_t value;
      std::memcpy(&value, texel, sizeof value);
      value |= added;
      std::memcpy(texel, &value, sizeof value);
    }
    return add(std::move(result), key);
  }
  result.rgba.assign(std::size_t(result.width) * std::size_t(result.height) * 4, std::uint8_t(255));
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const auto image = images.find(channels[c].name);
    if (image == images.end() || !image->second) continue;
    const Texture& from = *image->second;
    for (int y = 0; y < result.height; ++y)
      for (int x = 0; x < result.width; ++x) {
        const std::size_t from_x = std::size_t(x) * from.width / result.width,
                          from_y = std::size_t(y) * from.height / result.height;
        result.rgba[4 * (std::size_t(y) * result.width + x) + c] =
            from.rgba[4 * (from_y * from.width + from_x) + std::size_t(channels[c].channel)];
      }
  }
  return add(std::move(result), key);
}

int TextureCache::find_linear(const std::string& name) { return find_packed({{{name, 0}, {name, 1}, {name, 2}}}); }

int TextureCache::find_normals_of_heights(const std::string& name, float scale) {
  const std::string key = fmt::format("\nheights {} {}", scale, name);
  if (const auto known = index_of.find(key); known != index_of.end()) return known->second;
  const std::optional<Texture> heights = read_or_warn(name, "it is left out", true);
  if (!heights) return index_of[key] = kNoTexture;
  Texture result = *heights;
  result.linear = true;
  const auto height_at = [&](int x, int y) {  // the texture repeats
    x = (x + heights->width) % heights->width;
    y = (y + heights->height) % heights->height;
    return float(heights->rgba[4 * (std::size_t(y) * heights->width + x)]) * (scale / 255.0f);
  };
  for (int y = 0; y < result.height; ++y)
    for (int x = 0; x < result.width; ++x) {
      // Row 0 is at the top, where v is 1.
      const glm::vec3 normal = glm::normalize(glm::vec3(0.5f * (height_at(x - 1, y) - height_at(x + 1, y)),
                                                        0.5f * (height_at(x, y + 1) - height_at(x, y - 1)), 1.0f));
      std::uint8_t* to = &result.rgba[4 * (std::size_t(y) * result.width + x)];
      for (int c = 0; c < 3; ++c) to[c] = std::uint8_t((0.5f * normal[c] + 0.5f) * 255.0f + 0.5f);
      to[3] = 255;
    }
  return add(std::move(result), key);
}

}  // namespace umbrage
