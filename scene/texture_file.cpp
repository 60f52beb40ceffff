// Reads textures through stb_image, and nothing else of it leaves this file.
#include "scene/texture_file.h"

#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <new>
#include <vector>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_FAILURE_USERMSG
#include <stb_image.h>

namespace umbrage {
namespace {

/// A gigabyte of RGBA: the header of a broken file may ask for any size.
constexpr std::int64_t kMostPixels = std::int64_t(1) << 28;

}  // namespace

Result<Texture> decode_texture(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (bytes.empty()) return file_error("{} is empty, which is no image", name);
  if (bytes.size() > std::size_t(std::numeric_limits<int>::max())) return file_error("{} is larger than 2 GB", name);
  const int size = int(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (!stbi_info_from_memory(bytes.data(), size, &width, &height, &channels)) {
    return file_error("{} is no image of a known format (PNG, JPEG, TGA, BMP, GIF, PSD, HDR, PNM)", name);
  }
  if (std::int64_t(width) * height > kMostPixels) {
    return file_error("{} says that it has {} x {} pixels, more than a texture can have here ({})", name, width, height,
                      kMostPixels);
  }
  constexpr int kRgba = 4;
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, kRgba), stbi_image_free);
  if (!pixels || width <= 0 || height <= 0) {
    const char* reason = stbi_failure_reason();
    return file_error("{} is a broken image: {}", name, reason ? reason : "it holds no pixels");
  }
  Texture texture;
  texture.name = name;
  texture.width = width;
  texture.height = height;
  texture.rgba.assign(pixels.get(), pixels.get() + std::size_t(width) * height * kRgba);
  return texture;
}

Result<Texture> read_texture(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return file_error("{} cannot be opened", file.string());
  const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), {}};
  if (stream.bad()) return file_error("{} cannot be read", file.string());
  return decode_texture({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, file.string());
}

}  // namespace umbrage
