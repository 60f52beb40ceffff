// Reads textures and panoramas through stb_image, which is used only in this file.
#include "scene/readers/texture_file.h"

#include <array>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <vector>

#include "core/srgb.h"
#include "scene/readers/radiance.h"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_FAILURE_USERMSG
#include <stb_image.h>

namespace umbrage {
namespace {

/// Max pixels of a texture: a gigabyte of RGBA. The header of a damaged file may contain any size.
constexpr std::int64_t kMaxTexturePixels = std::int64_t(1) << 28;

/// The size in an image's header.
struct ImageHeader {
  int width = 0, height = 0;
};

Result<ImageHeader> check_header(std::span<const std::uint8_t> bytes, const std::string& name, std::int64_t max) {
  if (bytes.empty()) return file_error("'{}' is empty", name);
  if (bytes.size() > std::size_t(std::numeric_limits<int>::max())) return file_error("'{}' is larger than 2 GB", name);
  ImageHeader header;
  int channels = 0;
  if (!stbi_info_from_memory(bytes.data(), int(bytes.size()), &header.width, &header.height, &channels)) {
    return file_error("'{}' is not an image of a known format (PNG, JPEG, TGA, BMP, GIF, PSD, HDR, PNM)", name);
  }
  if (std::int64_t(header.width) * header.height > max) {
    return file_error("'{}' has {} x {} pixels in its header; at most {} can be read", name, header.width,
                      header.height, max);
  }
  return header;
}

Error damaged_image_error(const std::string& name) {
  const char* reason = stbi_failure_reason();
  return file_error("'{}' is a damaged image: {}", name, reason ? reason : "it has no pixels");
}

Result<std::vector<std::uint8_t>> read_bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return file_error("'{}' cannot be opened", file.string());
  std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(stream), {}};
  if (stream.bad()) return file_error("'{}' cannot be read", file.string());
  return bytes;
}

}  // namespace

Result<Texture> decode_texture(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (const auto header = check_header(bytes, name, kMaxTexturePixels); !header) return header.error();
  const int size = int(bytes.size());
  int width = 0, height = 0, channels = 0;
  constexpr int kRgba = 4;
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, kRgba), stbi_image_free);
  if (!pixels || width <= 0 || height <= 0) return damaged_image_error(name);
  Texture texture;
  texture.name = name;
  texture.width = width;
  texture.height = height;
  texture.rgba.assign(pixels.get(), pixels.get() + std::size_t(width) * height * kRgba);
  return texture;
}

Result<Texture> read_texture(const std::filesystem::path& file) {
  const auto bytes = read_bytes(file);
  return bytes ? decode_texture(*bytes, file.string()) : bytes.error();
}

Result<Panorama> decode_panorama(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (is_radiance(bytes)) return decode_radiance(bytes, name, kMaxPanoramaPixels);
  const auto header = check_header(bytes, name, kMaxPanoramaPixels);
  if (!header) return header.error();
  constexpr int kRgb = 3;
  const int size = int(bytes.size());
  Panorama panorama{name, header->width, header->height, {}};
  const std::size_t values = std::size_t(header->width) * std::size_t(header->height) * kRgb;
  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, kRgb), stbi_image_free);
  if (!pixels || width != header->width || height != header->height) return damaged_image_error(name);
  std::array<float, 256> linear;
  for (int v = 0; v < 256; ++v) linear[std::size_t(v)] = linear_from_srgb(float(v) / 255.0f);
  panorama.rgb.reserve(values);
  for (std::size_t k = 0; k < values; ++k) panorama.rgb.push_back(linear[pixels.get()[k]]);
  return panorama;
}

Result<Panorama> read_panorama(const std::filesystem::path& file) {
  const auto bytes = read_bytes(file);
  if (!bytes) return bytes.error();
  auto panorama = decode_panorama(*bytes, file.string());
  if (!panorama) return panorama;
  return reduced_panorama(*panorama, kMaxPanoramaWidth, kMaxPanoramaHeight);
}

}  // namespace umbrage
