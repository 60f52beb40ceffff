// Texture files: PNG, JPEG, TGA, BMP, GIF, HDR and others become a Texture.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "core/result.h"
#include "scene/environment.h"
#include "scene/scene.h"

namespace umbrage {

/// Decodes an image that lies in memory; `name` is for messages.
/// Errors: kFile where the bytes are no image that stb_image reads, or one too large to keep.
Result<Texture> decode_texture(std::span<const std::uint8_t> bytes, const std::string& name);

/// Reads and decodes a file. Errors: kFile.
Result<Texture> read_texture(const std::filesystem::path& file);

/// Of an image of what is around a scene: 16384 x 8192.
inline constexpr std::int64_t kMaxPanoramaPixels = std::int64_t(1) << 27;
/// What is larger is reduced to this as it is read.
inline constexpr int kMaxPanoramaWidth = 8192, kMaxPanoramaHeight = 4096;

/// The same for an image of what is around a scene: HDR as it is, other formats as sRGB. Errors: kFile.
Result<Panorama> decode_panorama(std::span<const std::uint8_t> bytes, const std::string& name);
Result<Panorama> read_panorama(const std::filesystem::path& file);

}  // namespace umbrage
