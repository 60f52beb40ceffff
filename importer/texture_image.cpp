#include "importer/texture_image.h"

#include <webp/decode.h>

#include <cstring>

#include "scene/readers/texture_file.h"
#include "scene/readers/whole_file.h"

namespace umbrage {
namespace {

bool starts_with(std::span<const std::uint8_t> bytes, std::size_t at, const char* text, std::size_t length) {
  return bytes.size() >= at + length && std::memcmp(bytes.data() + at, text, length) == 0;
}

Result<Texture> decode_webp(std::span<const std::uint8_t> bytes, const std::string& name) {
  Texture texture;
  texture.name = name;
  // A WebP image has at most 16383 x 16383 pixels.
  if (!WebPGetInfo(bytes.data(), bytes.size(), &texture.width, &texture.height) || texture.width <= 0 ||
      texture.height <= 0)
    return file_error("'{}' is a damaged WebP image", name);
  texture.rgba.resize(std::size_t(texture.width) * std::size_t(texture.height) * 4);
  if (!WebPDecodeRGBAInto(bytes.data(), bytes.size(), texture.rgba.data(), texture.rgba.size(), 4 * texture.width))
    return file_error("'{}' is a damaged WebP image", name);
  return texture;
}

}  // namespace

Result<Texture> decode_texture_image(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (starts_with(bytes, 0, "RIFF", 4) && starts_with(bytes, 8, "WEBP", 4)) return decode_webp(bytes, name);
  if (starts_with(bytes, 0, "\xABKTX 20\xBB\r\n\x1A\n", 12))
    return file_error("'{}' is a KTX2 image (KHR_texture_basisu), which is not read", name);
  return decode_texture(bytes, name);
}

Result<Texture> read_texture_image(const std::filesystem::path& file) {
  const auto bytes = read_whole_file(file);
  if (!bytes) return bytes.error();
  return decode_texture_image({reinterpret_cast<const std::uint8_t*>(bytes->data()), bytes->size()}, file.string());
}

}  // namespace umbrage
